#pragma once
#include <cstddef>

#include "describe.hpp"
#include "text.hpp"

/// Members of a struct as Python sees them, at run time: a table made from its description, so that the functions that read, show
/// and compare are compiled once, not once for each struct.
namespace strainwave::host {

/// True if a value is a T that was made: one from `T.__new__` alone holds nothing.
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

/// True for a number that counts something.
template <class T>
constexpr bool is_whole(const Field& field) {
    return std::is_same_v<T, int> || field.whole;
}

/// Reads a member from Python, or raises an error.
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
        constexpr int capacity = sizeof(list.item) / sizeof(list.item[0]);
        int count = 0;
        for (nb::handle item : nb::iter(value)) {
            if (count == capacity)
                throw nb::value_error(
                    (owner + "." + field.name + " holds at most " + std::to_string(capacity) + " elements").c_str());
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

/// The type of a member in Python's type annotations.
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

/// Choices of a member: models by their names in files, or the names of an enumeration.
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

/// Warns that a model can create energy, if it violates its rule.
void check_passivity(const Condition<double>& rule, const char* name);

/// The name of a type with that of its module.
std::string qualified(nb::handle type);

template <class M>
const Description& description_of();

/// The operations on members of one C++ type.
struct MemberType {
    const char* kind;  ///< "number", "count", "sequence", "part" or "choice"
    bool numeric;      ///< True if it has a unit and limits
    bool listed;       ///< True if it is one of a few names
    bool whole;        ///< True if it counts something, whatever its field states
    bool counted;      ///< True if it contains its own count
    nb::object (*to_python)(const void* member);
    void (*read)(void* member, nb::handle value, const Reader& reader, const Field& field);
    std::string (*python_type)(bool argument);
    nb::object (*options)();
    PartOf (*part)(const void* member);            ///< null if it is none
    int (*count)(const void* member);              ///< of its numbers; of one that counts or is listed, what it is
    double* (*number)(void* member, int element);  ///< null if it has none
};

namespace detail {

template <class T>
PartOf part_in(const void* member) {
    const T& part = *static_cast<const T*>(member);
    if constexpr (is_choice<T>)
        return part.visit([&]<class Law>(const Law& law) { return PartOf{&description_of<Law>(), &law, int(part.model.index())}; });
    else
        return {&description_of<T>(), member, -1};
}
template <class T>
int count_in(const void* member) {
    const T& value = *static_cast<const T*>(member);
    if constexpr (is_sequence<T> || is_array<T>)
        return value.size();
    else if constexpr (std::is_enum_v<T> || std::is_same_v<T, int>)
        return int(value);
    else
        return 1;
}
template <class T>
double* number_in(void* member, int element) {
    if constexpr (is_sequence<T> || is_array<T>)
        return &(*static_cast<T*>(member))[element];
    else
        return static_cast<double*>(member);
}

}  // namespace detail

template <class T>
inline constexpr bool is_part = is_choice<T> || Described<T>;
template <class T>
inline constexpr bool has_numbers = !is_part<T> && !std::is_enum_v<T> && !std::is_same_v<T, int>;

template <class T>
constexpr MemberType made_member_type() {
    MemberType type{is_sequence<T> || is_array<T> ? "sequence"
                    : is_part<T>                  ? "part"
                    : std::is_enum_v<T>           ? "choice"
                                                  : "number",
                    !is_part<T> && !std::is_enum_v<T>,
                    std::is_enum_v<T>,
                    std::is_same_v<T, int>,
                    is_sequence<T>,
                    [](const void* member) { return to_python(*static_cast<const T*>(member)); },
                    [](void* member, nb::handle value, const Reader& reader, const Field& field) {
                        *static_cast<T*>(member) = reader.template read<T>(value, field);
                    },
                    [](bool argument) { return python_type<T>(argument); },
                    [] { return options_of<T>(); },
                    nullptr,
                    nullptr,
                    nullptr};
    if constexpr (is_part<T>)
        type.part = &detail::part_in<T>;
    else
        type.count = &detail::count_in<T>;
    if constexpr (has_numbers<T>) type.number = &detail::number_in<T>;
    return type;
}
template <class T>
inline constexpr MemberType member_type = made_member_type<T>();

/// A member of a struct: its description, place and type.
struct Member {
    Field field;
    std::ptrdiff_t offset;
    const MemberType* type;

    const void* in(const void* model) const { return static_cast<const char*>(model) + offset; }
    void* in(void* model) const { return static_cast<char*>(model) + offset; }
    nb::object value(const void* model) const { return type->to_python(in(model)); }
    const char* kind() const { return type->numeric && (type->whole || field.whole) ? "count" : type->kind; }
};

/// A struct as Python binds it. Functions of a model get it as a pointer.
struct Description {
    const char* python_name;
    std::string name;    ///< in files and messages
    const char* doc;     ///< or null
    const char* source;  ///< or null
    std::vector<Member> members;
    const void* defaults;                        ///< a model as C++ makes it
    void (*copy)(void* to, const void* from);    ///< to where none is yet
    nb::object (*cast)(const void* model);       ///< a copy for Python
    std::string (*problem)(const void* model);   ///< how its own numbers contradict each other; empty if they do not
    void (*check_passivity)(const void* model);  ///< null if it cannot create energy
    nb::handle (*python_type)();
};

template <class M>
inline const Description* bound_description = nullptr;
/// Description of a bound struct.
template <class M>
const Description& description_of() {
    return *bound_description<M>;
}

template <class M>
const Description& describe(const char* python_name, const std::string& name) {
    static const M defaults{};
    static const Description description = [&] {
        Description made{};
        made.python_name = python_name;
        made.name = name;
        if constexpr (requires { M::doc; }) made.doc = M::doc;
        if constexpr (requires { M::source; }) made.source = M::source;
        M::fields(defaults, [&]<class T>(const T& member, const Field& field) {
            made.members.push_back(
                {field, reinterpret_cast<const char*>(&member) - reinterpret_cast<const char*>(&defaults), &member_type<T>});
        });
        made.defaults = &defaults;
        made.copy = [](void* to, const void* from) { new (to) M(*static_cast<const M*>(from)); };
        made.cast = [](const void* model) { return nb::cast(*static_cast<const M*>(model)); };
        made.problem = [](const void* model) { return own_problem_of(*static_cast<const M*>(model)); };
        if constexpr (requires { defaults.passivity(); })
            made.check_passivity = [](const void* model) { check_passivity(static_cast<const M*>(model)->passivity(), M::name); };
        made.python_type = [] { return nb::type<M>(); };
        return made;
    }();
    bound_description<M> = &description;
    return description;
}

/// Description of a bound struct by an object; an error if it is none.
const Description& description_of(nb::handle object);

/// The model that a Python object holds; refused if it is none of this type.
const void* model_in(nb::handle object, const Description& description);

/// The model with other numbers; an error if they contradict each other.
nb::object with_numbers(const void* model, const Description& description, const std::vector<double>& numbers);

/// Help for a struct: its doc, members, errors and source.
std::string documentation(const Description& description);

/// Constructor, copies, properties, repr, equality, hash and pickling of a frozen value.
void define_value(nb::handle type, const Description& description);

}  // namespace strainwave::host
