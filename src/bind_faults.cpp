#include <strainwave/fault/models.hpp>
#include <strainwave/onset/models.hpp>

#include "laws.hpp"

namespace strainwave::host {

namespace {

using Facts = strainwave::fault::Facts<double>;
using Change = strainwave::fault::Change<double>;

#define SW_CHANGES "tuple[tuple[str, str, str, float, str, str, float, float], ...]"

nb::tuple as_tuple(const Change& change) {
    return nb::make_tuple(change.place, change.quantity, choices(change.kind)[int(change.kind)], change.value, change.law,
                          change.direction, change.phase, change.order);
}

struct FaultVerbs {
    template <class M>
    static void add(const Bound<M>& c, int) {
        c.type.attr("mode") = M::mode;
        c.type.attr("effect") = M::effect;
        c.type.attr("signal") = M::signal;
        verb(c, "changes", {{"facts", qualified(description_of<Facts>()).c_str()}}, SW_CHANGES,
             "Return the changes of the fault to a drive of these `facts`, in the same order at every severity: place, quantity, "
             "kind, value, law, direction, phase [rad] and order of each. `ValueError` if the drive lacks a fact that the fault "
             "needs.",
             [](const M& m, const Call& call) -> nb::object {
                 const auto facts = call.part<Facts>("facts");
                 if constexpr (requires { m.missing(facts); })
                     if (const char* text = m.missing(facts))
                         throw nb::value_error((std::string(M::name) + " needs " + text).c_str());
                 nb::list list;
                 m.changes(facts, [&](const Change& change) { list.append(as_tuple(change)); });
                 return nb::tuple(list);
             });
    }
};

struct OnsetVerbs {
    template <class M>
    static void add(const Bound<M>& c, int) {
        const char* doc =
            "Return the share [1], in [0, 1], of its severity that a fault has after a `usage`, of the shape of `usage`.";
        define_function(c.type, c.description, "share", {{"usage", "float"}}, doc,
                        [](const void* m, const double* usage) { return static_cast<const M*>(m)->share(*usage); });
        verb(c, "share", {{"usage", SW_NUMBERS}}, SW_ARRAY, doc, [](const M& m, const Call& call) -> nb::object {
            const auto usage = numbers(call["usage"], "usage");
            if (usage.ndim() == 0) return nb::float_(m.share(*usage.data()));
            auto [out, y] = like(usage);
            for (std::size_t i = 0; i < usage.size(); ++i) {
                let_interrupt(i);
                y[i] = m.share(usage.data()[i]);
            }
            return nb::cast(out);
        });
    }
};

/// Models that change a drive, apart from the families that a drive is made of.
template <class Verbs, class L>
void bind_around_drives(nb::module_& core, nb::module_ family, const char* name, L list) {
    bind_list<Verbs>(core, family, name, list, "fault_families");
}

}  // namespace

void bind_faults(nb::module_& core) {
    core.attr("fault_families") = nb::dict();
    nb::module_ fault = family_module(core, "fault", "Faults of a drive: changes of its numbers, each by its severity.");
    bind<Facts>(fault, "Facts", "facts");
    bind_around_drives<FaultVerbs>(core, fault, "fault", strainwave::fault::Models{});
    bind_around_drives<OnsetVerbs>(
        core, family_module(core, "onset", "Onsets of faults: the share of the severity after some use of a drive."), "onset",
        strainwave::onset::Models{});
}

}  // namespace strainwave::host
