#include "names.hpp"

#include <map>

#include "general/drive.hpp"

namespace strainwave::host {

namespace {

template <class Law>
using StateOf = general::StateOf<double, Law>;

/// The described struct of the outputs of a law.
template <class Law>
constexpr auto output_of_law() {
    if constexpr (requires { typename Law::Output; })
        return typename Law::Output{};
    else
        return Stateless<double>{};
}

/// Adds the numbers of one part to the names of a drive.
struct NamesOfPart {
    std::string part;
    std::vector<Name>& names;

    void add(const std::string& before, int element, const Field& field) const {
        names.push_back({part, before + field.name, element, field});
    }
};

template <class X, class Law>
void each_name(const Law& law, const std::string& before, const NamesOfPart& names);

/// Names of a struct within another: of the part of that name, if the law has one.
template <class X, class Law>
void each_name_within(const Law& law, const std::string& before, const Field& field, const NamesOfPart& names) {
    bool is_of_part = false;
    general::with_part(law, field.name, [&](const auto& part) {
        is_of_part = true;
        each_name<X>(part, before + field.name + ".", names);
    });
    if (!is_of_part) each_name<X>(law, before + field.name + "_", names);
}

/// Adds each number of a struct of a law, with a name that begins with `before`.
template <class X, class Law>
void each_name(const Law& law, const std::string& before, const NamesOfPart& names) {
    if constexpr (stands_for_chosen<X>) {  // a law that varies another has its state
        law.law.visit([&]<class Inner>(const Inner& inner) { each_name<StateOf<Inner>>(inner, before, names); });
    } else {
        X numbers{};
        X::fields(numbers, [&]<class T>(const T& member, const Field& field) {
            if constexpr (stands_for_chosen<T>)
                general::with_part(law, field.name, [&](const auto& part) {
                    if constexpr (requires { part.model; })
                        part.visit([&]<class Inner>(const Inner& inner) {
                            each_name<StateOf<Inner>>(inner, before + field.name + ".", names);
                        });
                });
            else if constexpr (Described<T>)
                each_name_within<T>(law, before, field, names);
            else if constexpr (requires { member.item; })
                for (int i = 0; i < member.size(); ++i) names.add(before, i, field);
            else
                names.add(before, -1, field);
        });
    }
}

/// Visits a struct of the general drive; the names of the numbers of a part come from its law.
template <bool of_output>
struct NameWalk {
    const ParameterDrive& drive;
    std::vector<Name>& names;
    std::string path = "";
    bool discrete = false;

    template <class T>
    void operator()(const T& member, const Field& field) const {
        const std::string name = field.name;
        if constexpr (kernel::Slots<T>) {
            each_of_part(path + name);
        } else if constexpr (Described<T>) {
            const bool is_part = name != "continuous" && name != "discrete";
            T::fields(member, NameWalk{drive, names, is_part ? path + name + "." : path, discrete || name == "discrete"});
        } else {
            names.push_back({"", name, -1, field});
        }
    }

private:
    void each_of_part(const std::string& part) const {
        drive.stateful_parts([&](const char* name, const auto& choice) {
            if (part == name) choice.visit([&](const auto& law) { each_of(law, {part, names}); });
        });
    }
    template <class Law>
    void each_of(const Law& law, const NamesOfPart& named) const {
        if constexpr (of_output)
            each_name<decltype(output_of_law<Law>())>(law, "", named);
        else if (discrete)
            each_name<control::DiscreteOf<double, Law>>(law, "", named);
        else
            each_name<StateOf<Law>>(law, "", named);
    }
};

template <bool of_output, class X>
std::vector<Name> names_in(const X& numbers, const ParameterDrive& drive) {
    std::vector<Name> names;
    X::fields(numbers, NameWalk<of_output>{drive, names});
    return names;
}

}  // namespace

const Layout& layout_of(const ParameterDrive& drive, const std::vector<int>& laws) {
    using General = general::GeneralDrive<double>;
    static std::map<std::vector<int>, Layout> known;
    const auto found = known.find(laws);
    if (found != known.end()) return found->second;
    const Layout layout{names_in<false>(General::State{}, drive), names_in<true>(General::Output{}, drive),
                        names_in<false>(General::Continuous{}, drive).size()};
    return known.emplace(laws, layout).first->second;
}

}  // namespace strainwave::host
