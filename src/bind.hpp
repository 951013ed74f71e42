#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <new>

#include "describe.hpp"

/// One function binds every described struct: keyword constructor, properties, checks, repr, equality, help; and the verbs it has.
namespace strainwave::host {

namespace nb = nanobind;
/// How Python's type checkers see an array.
#define SW_ARRAY "numpy.typing.NDArray[numpy.float64]"
using Values = nb::ndarray<nb::numpy, double, nb::c_contig>;
using Numbers = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
using Flags = nb::ndarray<const std::uint8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

/// Room for so many numbers, not yet filled; or a MemoryError that says how many they are.
template <class T = double>
std::unique_ptr<T[]> room(std::size_t size) {
    std::unique_ptr<T[]> numbers(new (std::nothrow) T[size + 1]);
    if (numbers) return numbers;
    PyErr_Format(PyExc_MemoryError, "there is no memory for %zu numbers, which take %zu MB; take fewer at a time", size,
                 size / 1000000 * sizeof(T));
    throw nb::python_error();
}

/// An array that Python owns, not yet filled.
template <class T = double>
nb::ndarray<nb::numpy, T, nb::c_contig> array(const std::vector<std::size_t>& shape) {
    std::size_t size = 1;
    for (std::size_t n : shape) size *= n;
    auto* const data = room<T>(size).release();
    nb::capsule owner(data, [](void* p) noexcept { delete[] static_cast<T*>(p); });
    return {data, shape.size(), shape.data(), owner};
}

inline std::string shortest(double x) {
    const std::unique_ptr<char, void (*)(void*)> text(PyOS_double_to_string(x, 'r', 0, 0, nullptr), PyMem_Free);
    return text.get();
}

inline std::string with_unit(double x, const char* unit) {
    return shortest(x) + (std::strcmp(unit, "1") == 0 ? "" : std::string(" ") + unit);
}

/// "[0, inf)": what a field may be.
inline std::string limits(const Field& field) {
    const bool open_low = field.min <= -unbounded, open_high = field.max >= unbounded, positive = field.min == smallest;
    return (open_low   ? "(-inf"
            : positive ? "(0"
                       : "[" + shortest(field.min)) +
           ", " + (open_high ? "inf)" : shortest(field.max) + "]");
}

/// In words and numbers, that a law is used where it is not valid.
inline std::string outside(const Domain<double>& domain) {
    return std::string(domain.name) + " = " + with_unit(domain.value, domain.unit) + " lies outside of [" + shortest(domain.low) +
           ", " + with_unit(domain.high, "1") + "]" + (std::strcmp(domain.unit, "1") == 0 ? "" : " " + std::string(domain.unit)) +
           (*domain.remedy ? std::string("; ") + domain.remedy : "");
}

inline std::string text_of(nb::handle value) { return nb::cast<std::string>(nb::repr(value)); }

/// The same, cut short where it is long; of a value that was never made, that.
inline std::string shortened(nb::handle value) {
    if (nb::inst_check(value) && !nb::inst_ready(value))
        return "a " + nb::cast<std::string>(value.type().attr("__name__")) + " that was never made";
    return nb::cast<std::string>(nb::module_::import_("reprlib").attr("repr")(value));
}

/// Whether a value is a T that was made: one from `T.__new__` alone holds nothing.
template <class T>
bool is_made(nb::handle value) {
    return nb::isinstance<T>(value) && nb::inst_ready(value);
}

/// Takes a value for a number: no truth value, no text, and no array of other values, of which a cast would make a number.
inline bool to_number(nb::handle value, double& x) {
    if (nb::isinstance<nb::bool_>(value) || nb::isinstance<nb::str>(value)) return false;
    if (nb::hasattr(value, "mask")) return false;
    if (nb::hasattr(value, "dtype") && !nb::cast<bool>(nb::str("fiu").attr("__contains__")(value.attr("dtype").attr("kind"))))
        return false;
    return nb::try_cast<double>(value, x);
}

/// Whether a number counts something.
template <class T>
constexpr bool is_whole(const Field& field) {
    return std::is_same_v<T, int> || field.whole;
}

/// Reads a member from Python, or says what is wrong with it.
struct Reader {
    std::string owner;

    [[noreturn]] void refuse_type(const Field& field, const std::string& wanted, nb::handle value) const {
        throw nb::type_error((owner + "." + field.name + " must be " + wanted + ", not " + shortened(value)).c_str());
    }
    double number(nb::handle value, const Field& field, const std::string& name) const {
        double x = 0.0;
        if (!to_number(value, x)) refuse_type(field, "a number", value);
        if (!(x >= field.min && x <= field.max) || std::isinf(x))
            throw nb::value_error(
                (owner + "." + name + " = " + with_unit(x, field.unit) + " must lie in " + limits(field)).c_str());
        return x;
    }

    template <class T>
    T read(nb::handle value, const Field& field) const {
        if constexpr (is_choice<T>) {
            return choose<T>(value, field);
        } else if constexpr (is_slots<T>) {
            return {sequence<decltype(T{}.slot)>(value, field)};
        } else if constexpr (Described<T>) {
            if (!is_made<T>(value)) refuse_type(field, "a " + nb::cast<std::string>(nb::type<T>().attr("__name__")), value);
            return nb::cast<T>(value);
        } else if constexpr (is_sequence<T> || is_array<T>) {
            return sequence<T>(value, field);
        } else if constexpr (std::is_enum_v<T>) {
            std::string names;
            for (int i = 0; const char* name : choices(T{}).item) {
                if (nb::isinstance<nb::str>(value) && nb::cast<std::string>(value) == name) return T(i);
                names += std::string(i++ ? " or " : "") + "'" + name + "'";
            }
            refuse_type(field, names, value);
        } else {
            const double x = number(value, field, field.name);
            if (is_whole<T>(field) && x != std::floor(x)) refuse_type(field, "a whole number", value);
            return T(x);
        }
    }

private:
    template <class T>
    T choose(nb::handle value, const Field& field) const {
        T choice{};
        std::string names;
        bool found = false;
        const auto attempt = [&]<class Law>(const Law*) {
            names += (names.empty() ? "" : ", ") + std::string(nb::cast<std::string>(nb::type<Law>().attr("__name__")));
            if (!found && is_made<Law>(value)) {
                choice.model = nb::cast<Law>(value);
                found = true;
            }
        };
        [&]<class S, class... Law>(const Choice<S, Law...>*) { (attempt(static_cast<const Law*>(nullptr)), ...); }(&choice);
        if (!found) refuse_type(field, "one of " + names, value);
        return choice;
    }
    /// A sequence of numbers; a number alone is a sequence of one.
    template <class T>
    T sequence(nb::handle value, const Field& field) const {
        T list{};
        if (double alone = 0.0; is_sequence<T> && to_number(value, alone)) {
            list[0] = number(value, field, field.name);
            if constexpr (is_sequence<T>) list.count = 1;
            return list;
        }
        if (nb::isinstance<nb::str>(value) || !nb::hasattr(value, "__iter__")) refuse_type(field, "a sequence of numbers", value);
        constexpr int most = sizeof(list.item) / sizeof(list.item[0]);
        int count = 0;
        for (nb::handle item : nb::iter(value)) {
            if (count == most)
                throw nb::value_error((owner + "." + field.name + " holds at most " + std::to_string(most) + " elements").c_str());
            list[count] = number(item, field, field.name + ("[" + std::to_string(count) + "]"));
            ++count;
        }
        if constexpr (is_sequence<T>) list.count = count;
        return list;
    }
};

template <class T>
nb::object to_python(const T& member) {
    if constexpr (is_choice<T>) {
        return member.visit([](const auto& law) { return nb::cast(law); });
    } else if constexpr (is_slots<T>) {
        return to_python(member.slot);
    } else if constexpr (Described<T>) {
        return nb::cast(member);
    } else if constexpr (is_sequence<T> || is_array<T>) {
        nb::list list;
        for (int i = 0; i < member.size(); ++i) list.append(member[i]);
        return nb::tuple(list);
    } else if constexpr (std::is_enum_v<T>) {
        return nb::cast(choices(member)[int(member)]);
    } else {
        return nb::cast(member);
    }
}

/// How Python's type checkers see a member.
template <class T>
std::string python_type(bool argument) {
    if constexpr (is_choice<T>) {
        std::string names;
        [&]<class S, class... Law>(const Choice<S, Law...>*) {
            const auto add = [&](nb::handle type) {
                names += (names.empty() ? "" : " | ") + nb::cast<std::string>(type.attr("__module__")) + "." +
                         nb::cast<std::string>(type.attr("__qualname__"));
            };
            (add(nb::type<Law>()), ...);
        }(static_cast<const T*>(nullptr));
        return names;
    } else if constexpr (is_slots<T>) {
        return python_type<decltype(T{}.slot)>(argument);
    } else if constexpr (Described<T>) {
        const auto type = nb::type<T>();
        return nb::cast<std::string>(type.attr("__module__")) + "." + nb::cast<std::string>(type.attr("__qualname__"));
    } else if constexpr (is_sequence<T> || is_array<T>) {
        if (!argument) return "tuple[float, ...]";
        return is_sequence<T> ? "float | collections.abc.Sequence[float]" : "collections.abc.Sequence[float]";
    } else if constexpr (std::is_enum_v<T>) {
        return "str";
    } else if constexpr (std::is_same_v<T, int>) {
        return "int";
    } else {
        return "float";
    }
}

/// A text written in a raw string, with the indent of its source taken off.
inline std::string dedented(const char* text) {
    nb::object clean = nb::module_::import_("inspect").attr("cleandoc")(text);
    return nb::cast<std::string>(clean);
}

/// Keeps what nanobind only points at.
inline const char* kept(std::string text) {
    static std::vector<std::unique_ptr<std::string>> texts;
    texts.push_back(std::make_unique<std::string>(std::move(text)));
    return texts.back()->c_str();
}

/// What a member may be chosen from: models by their names in files, or the names of an enumeration.
template <class T>
nb::object options_of() {
    if constexpr (is_choice<T>) {
        nb::dict models;
        [&]<class S, class... Law>(const Choice<S, Law...>*) {
            ((models[Law::name] = nb::type<Law>()), ...);
        }(static_cast<const T*>(nullptr));
        return models;
    } else if constexpr (std::is_enum_v<T>) {
        nb::list names;
        for (const char* name : choices(T{}).item) names.append(name);
        return nb::tuple(names);
    } else {
        return nb::none();
    }
}

template <class M>
std::string documentation() {
    std::string text;
    if constexpr (requires { M::doc; }) text = dedented(M::doc) + "\n\n";
    text += "Parameters\n----------\n";
    const M model{};
    const auto describe = [&]<class T>(const T& member, const Field& field) {
        text += std::string(field.name) + ": " + field.doc;
        if constexpr (!Described<T> && !is_choice<T>) {
            if constexpr (!std::is_enum_v<T>) {
                if (std::strcmp(field.unit, "1") != 0) text += std::string(" [") + field.unit + "]";
                if (field.min > -unbounded || field.max < unbounded) text += ", in " + limits(field);
            }
            if constexpr (std::is_enum_v<T>) text += ", one of " + text_of(options_of<T>());
        }
        text += field.required  ? "; required\n"
                : field.follows ? std::string("; default as ") + field.follows + "\n"
                                : "; default " + text_of(to_python(member)) + "\n";
    };
    M::fields(model, describe);
    text +=
        "\nRaises\n------\nTypeError: an unknown parameter, one of the wrong kind, or none where it is required\nValueError: a "
        "number that is not finite or "
        "out of its range\n";
    if constexpr (requires { M::source; }) text += std::string("\nSource\n------\n") + M::source + "\n";
    return text;
}

template <class M>
void check_relations(const M& model, const std::string& name) {
    if constexpr (requires { model.problem(); })
        if (const char* problem = model.problem()) throw nb::value_error((name + ": " + problem).c_str());
}

/// Warns if the parameters let the model create energy.
template <class M>
void check_passivity(const M& model) {
    if constexpr (requires { model.passivity(); }) {
        const Condition<double> rule = model.passivity();
        if (rule.left >= rule.right) return;
        const std::string text = std::string(M::name) + " can create energy: " + rule.left_name + " = " +
                                 with_unit(rule.left, rule.unit) + " must be at least " + rule.right_name + " = " +
                                 with_unit(rule.right, rule.unit);
        if (PyErr_WarnEx(nb::module_::import_("strainwave._core").attr("PassivityWarning").ptr(), text.c_str(), 1) < 0)
            throw nb::python_error();
    }
}

/// The names of all members, for messages.
template <class M>
std::string names_of() {
    std::string names;
    const M model{};
    M::fields(model, [&](const auto&, const Field& field) { names += (names.empty() ? "" : ", ") + std::string(field.name); });
    return names;
}

/// Sets the members that `values` names; an unknown name is refused.
template <class M>
void set_members(M& model, const nb::kwargs& values, const std::string& name) {
    const Reader reader{name};
    nb::dict unknown(values);
    M::fields(model, [&]<class T>(T& member, const Field& field) {
        if (!values.contains(field.name)) return;
        member = reader.template read<T>(values[field.name], field);
        nb::del(unknown[field.name]);
    });
    for (auto [key, value] : unknown)
        throw nb::type_error((name + " has no parameter " + shortened(key) + "; it has " + names_of<M>()).c_str());
}

/// `model` with other values of the members that `values` names.
template <class M>
M replaced(M model, const nb::kwargs& values, const std::string& name) {
    set_members(model, values, name);
    check_relations(model, name);
    return model;
}

/// A new model of these values; refused where one that is required is not among them.
template <class M>
M made(nb::kwargs values, const std::string& name) {
    M model{};
    std::string missing;
    M::fields(model, [&](const auto&, const Field& field) {
        if (values.contains(field.name)) return;
        if (field.required) missing += (missing.empty() ? "" : ", ") + std::string(field.name);
        if (field.follows && values.contains(field.follows)) values[field.name] = values[field.follows];
    });
    set_members(model, values, name);
    if (!missing.empty()) throw nb::type_error((name + " needs " + missing + ": no value suits most gears").c_str());
    check_relations(model, name);
    return model;
}

/// Refuses parameters given by place, which nobody could read.
template <class M>
void check_named(const nb::args& unnamed, const std::string& name) {
    if (unnamed.size() > 0)
        throw nb::type_error(
            (name + " takes its parameters by name, not " + shortened(unnamed[0]) + " alone; it has " + names_of<M>()).c_str());
}

/// The members as Python sees them, by name.
template <class M>
nb::dict members(const M& model) {
    nb::dict dict;
    M::fields(model, [&](const auto& member, const Field& field) { dict[field.name] = to_python(member); });
    return dict;
}

template <class M>
std::string represented(const M& model, const std::string& name) {
    std::string text;
    M::fields(model, [&](const auto& member, const Field& field) {
        text += (text.empty() ? "" : ", ") + std::string(field.name) + "=" + text_of(to_python(member));
    });
    return name + "(" + text + ")";
}

/// "def head(self, *, name: type = ..., ...) -> result"; required members have no value by default where a model is made.
template <class M>
std::string signature(const std::string& head, const std::string& result, bool makes) {
    std::string text = "def " + head + "(self, *";
    const M defaults{};
    M::fields(defaults, [&]<class T>(const T&, const Field& field) {
        text += std::string(", ") + field.name + ": " + python_type<T>(true) + (makes && field.required ? "" : " = ...");
    });
    return text + ") -> " + result;
}

/// What is known of each member besides its value: name, unit, doc, limits (None: no limit) and whether the lower one is open, its
/// kind, and what it may be chosen from; whether it is required, the member it follows if it is not given, and its value by
/// default: an order of magnitude where that is not used.
template <class M>
nb::tuple schema() {
    nb::list list;
    const M model{};
    M::fields(model, [&]<class T>(const T& member, const Field& field) {
        nb::dict entry;
        entry["name"] = field.name;
        entry["unit"] = field.unit;
        entry["doc"] = field.doc;
        entry["min"] = field.min <= -unbounded ? nb::none() : nb::object(nb::float_(field.min == smallest ? 0.0 : field.min));
        entry["max"] = field.max >= unbounded ? nb::none() : nb::object(nb::float_(field.max));
        entry["kind"] = is_sequence<T> || is_array<T> || is_slots<T> ? "sequence"
                        : is_choice<T> || Described<T>               ? "part"
                        : std::is_enum_v<T>                          ? "choice"
                        : is_whole<T>(field)                         ? "count"
                                                                     : "number";
        entry["open"] = field.min == smallest;
        entry["options"] = options_of<T>();
        entry["required"] = field.required;
        entry["follows"] = field.follows ? nb::object(nb::str(field.follows)) : nb::none();
        entry["default"] = to_python(member);
        list.append(entry);
    });
    return nb::tuple(list);
}

/// Binds a described struct as a frozen value. None can be derived from: what is compiled would not call what Python overrides.
template <class M>
nb::class_<M> bind(nb::handle scope, const char* python_name, const std::string& name) {
    static_assert(fully_described<M>, "every member needs a Field");
    auto c = nb::class_<M>(scope, python_name, nb::is_final(), kept(documentation<M>()));
    c.def(
        "__init__",
        [name](M* self, const nb::args& unnamed, const nb::kwargs& values) {
            check_named<M>(unnamed, name);
            const M model = made<M>(values, name);
            check_passivity(model);
            new (self) M(model);
        },
        nb::sig(kept(signature<M>("__init__", "None", true))));
    c.def(
        "replace",
        [name](const M& self, const nb::args& unnamed, const nb::kwargs& values) {
            check_named<M>(unnamed, name);
            const M model = replaced(self, values, name);
            check_passivity(model);
            return model;
        },
        nb::sig(kept(signature<M>("replace", python_type<M>(false), false))), "The same with the named parameters changed.");
    const M defaults{};
    M::fields(defaults, [&]<class T>(const T& member, const Field& field) {
        const auto offset = reinterpret_cast<const char*>(&member) - reinterpret_cast<const char*>(&defaults);
        const std::string unit = *field.unit && std::strcmp(field.unit, "1") != 0 ? std::string(" [") + field.unit + "]" : "";
        c.def_prop_ro(
            field.name,
            [offset](const M& self) {
                return to_python(*reinterpret_cast<const T*>(reinterpret_cast<const char*>(&self) + offset));
            },
            nb::sig(kept(std::string("def ") + field.name + "(self) -> " + python_type<T>(false))), kept(field.doc + unit));
    });
    c.def("__repr__", [python_name](const M& self) { return represented(self, python_name); });
    c.def(
        "__eq__",
        [](const M& self, nb::handle other) { return is_made<M>(other) && parts_of(self) == parts_of(nb::cast<M>(other)); },
        nb::arg("other").none(), nb::sig("def __eq__(self, other: object, /) -> bool"));
    c.def("__hash__", [](const M& self) { return nb::hash(nb::tuple(members(self).values())); });
    c.def("__getstate__", [](const M& self) { return members(self); }, nb::sig("def __getstate__(self) -> dict[str, object]"));
    c.def(
        "__setstate__",
        [name](M* self, const nb::dict& state) { new (self) M(replaced(M{}, nb::borrow<nb::kwargs>(state), name)); },
        nb::sig("def __setstate__(self, state: dict[str, object], /) -> None"));
    c.def(
        "__reduce__",
        [](nb::handle self) {  // as every protocol of pickle can write it
            return nb::make_tuple(nb::module_::import_("copyreg").attr("__newobj__"), nb::make_tuple(self.type()),
                                  self.attr("__getstate__")());
        },
        nb::sig("def __reduce__(self) -> tuple[typing.Any, ...]"));
    c.attr("name") = name;
    if constexpr (requires { M::source; }) c.attr("source") = M::source;
    c.attr("fields") = schema<M>();
    return c;
}

}  // namespace strainwave::host
