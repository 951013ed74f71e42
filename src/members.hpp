#pragma once
#include <cstddef>

#include "describe.hpp"
#include "text.hpp"

/// Members of a struct as Python sees them, at run time: a table made from its description, so that the functions that read, show
/// and compare are compiled once, not once for each struct.
namespace strainwave::host {

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
        if (!to_number(value, x) && !text_to_number(value, field, name, x)) refuse_type(field, "a number", value);
        if (!(x >= field.min && x <= field.max) || std::isinf(x))
            throw nb::value_error(
                (owner + "." + name + " = " + with_unit(x, field.unit) + " must lie in " + limits(field)).c_str());
        return x;
    }

    template <class T>
    T read(nb::handle value, const Field& field) const {
        if constexpr (is_sequence<T> || is_array<T>) {
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
            check_whole<T>(x, field, value);
            return T(x);
        }
    }

private:
    template <class T>
    void check_whole(double x, const Field& field, nb::handle value) const {
        if (is_whole<T>(field) && x != std::floor(x)) refuse_type(field, "a whole number", value);
    }
    /// Takes a text with a unit, as "75 mN.m/A", for a number in the unit of the field, if that has one.
    bool text_to_number(nb::handle value, const Field& field, const std::string& name, double& x) const;

    /// A sequence of numbers; a number alone is a sequence of one.
    template <class T>
    T sequence(nb::handle value, const Field& field) const {
        T list{};
        const bool text = nb::isinstance<nb::str>(value);
        if (double alone = 0.0; is_sequence<T> && ((text && has_unit(field)) || to_number(value, alone))) {
            list[0] = number(value, field, field.name);
            check_whole<double>(list[0], field, value);
            if constexpr (is_sequence<T>) list.count = 1;
            return list;
        }
        if (text || !nb::hasattr(value, "__iter__")) refuse_type(field, "a sequence of numbers", value);
        constexpr int capacity = sizeof(list.item) / sizeof(list.item[0]);
        int count = 0;
        for (nb::handle item : nb::iter(value)) {
            if (count == capacity)
                throw nb::value_error(
                    (owner + "." + field.name + " holds at most " + std::to_string(capacity) + " elements").c_str());
            list[count] = number(item, field, field.name + ("[" + std::to_string(count) + "]"));
            check_whole<double>(list[count], field, item);
            ++count;
        }
        if constexpr (is_sequence<T>) list.count = count;
        return list;
    }
};

template <class T>
nb::object to_python(const T& member) {
    if constexpr (is_sequence<T> || is_array<T>) {
        nb::list list;
        for (int i = 0; i < member.size(); ++i) list.append(member[i]);
        return nb::tuple(list);
    } else if constexpr (std::is_enum_v<T>) {
        return nb::cast(choices(member)[int(member)]);
    } else {
        return nb::cast(member);
    }
}

/// The type of a member that is no part in Python's type annotations.
template <class T>
std::string python_type(const Field& field, bool argument) {
    const std::string number = argument && has_unit(field) ? "float | str" : "float";
    if constexpr (is_sequence<T> || is_array<T>) {
        if (!argument) return "tuple[float, ...]";
        return (is_sequence<T> ? number + " | " : "") + "collections.abc.Sequence[" + number + "]";
    } else if constexpr (std::is_enum_v<T>) {
        return "str";
    } else if constexpr (std::is_same_v<T, int>) {
        return "int";
    } else {
        return number;
    }
}

/// The names of an enumeration.
template <class T>
nb::object options_of() {
    if constexpr (std::is_enum_v<T>) {
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

/// A type that a part may have: its own, or that of a law that it is chosen from.
struct Alternative {
    const Description& (*description)();
    void (*assign)(void* member, const void* law);  ///< makes the member a copy of the law
};

/// The operations on members of one C++ type. Those on parts are the same for all: they go by the alternatives.
struct MemberType {
    const char* kind;  ///< "number", "count", "sequence", "part" or "choice"
    bool numeric;      ///< True if it has a unit and limits
    bool listed;       ///< True if it is one of a few names
    bool whole;        ///< True if it counts something, whatever its field states
    bool counted;      ///< True if it contains its own count
    bool chosen;       ///< True if it is a law chosen from several
    nb::object (*to_python)(const void* member) = nullptr;
    void (*read)(void* member, nb::handle value, const Reader& reader, const Field& field) = nullptr;
    std::string (*python_type)(const Field& field, bool argument) = nullptr;
    nb::object (*options)() = nullptr;
    PartOf (*part)(const void* member) = nullptr;  ///< null if it is none
    const Alternative* alternatives = nullptr;
    int alternative_count = 0;
    int (*count)(const void* member) = nullptr;              ///< of its numbers; of one that counts or is listed, what it is
    double* (*number)(void* member, int element) = nullptr;  ///< null if it has none
};

namespace detail {

template <class T>
struct Alternatives {
    static constexpr Alternative all[]{
        {&description_of<T>, [](void* member, const void* model) { *static_cast<T*>(member) = *static_cast<const T*>(model); }}};
    static PartOf part(const void* member) { return {&description_of<T>(), member, -1}; }
};
template <class S, class... Law>
struct Alternatives<Choice<S, Law...>> {
    using T = Choice<S, Law...>;
    static constexpr Alternative all[]{{&description_of<Law>, [](void* member, const void* law) {
                                            static_cast<T*>(member)->model.template emplace<Law>(*static_cast<const Law*>(law));
                                        }}...};
    static PartOf part(const void* member) {
        const T& choice = *static_cast<const T*>(member);
        const void* const law = choice.visit([](const auto& chosen) -> const void* { return &chosen; });
        const int index = int(choice.model.index());
        return {&all[index].description(), law, index};
    }
};
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
                    is_choice<T>};
    if constexpr (is_part<T>) {
        type.part = &detail::Alternatives<T>::part;
        type.alternatives = detail::Alternatives<T>::all;
        type.alternative_count = std::size(detail::Alternatives<T>::all);
    } else {
        type.to_python = [](const void* member) { return to_python(*static_cast<const T*>(member)); };
        type.read = [](void* member, nb::handle value, const Reader& reader, const Field& field) {
            *static_cast<T*>(member) = reader.template read<T>(value, field);
        };
        type.python_type = &python_type<T>;
        type.options = &options_of<T>;
        type.count = &detail::count_in<T>;
    }
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
    nb::object value(const void* model) const;
    /// Sets it in a model from Python, or raises an error.
    void read(void* model, nb::handle value, const Reader& reader) const;
    std::string python_type(bool argument) const;
    /// Choices of it: models by their names in files, or the names of an enumeration.
    nb::object options() const;
    bool is_whole() const { return type->whole || field.whole; }
    const char* kind() const { return same(type->kind, "number") && is_whole() ? "count" : type->kind; }
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
    std::string (*problem)(const void* model);   ///< how its own numbers contradict each other; empty if they do not
    void (*check_passivity)(const void* model);  ///< null if it cannot create energy
    nb::handle (*python_type)();

    /// Adds a member, which lies in `defaults`.
    void add(const Field& field, const void* member, const MemberType* type);
    /// True if a value is a model of this type that was made: one from `__new__` alone holds nothing.
    bool is_made(nb::handle value) const;
    /// A copy of a model for Python.
    nb::object cast(const void* model) const;
};

/// The type of a described struct in Python's type annotations.
std::string qualified(const Description& description);

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
        made.defaults = &defaults;
        made.python_name = python_name;
        made.name = name;
        if constexpr (requires { M::doc; }) made.doc = M::doc;
        if constexpr (requires { M::source; }) made.source = M::source;
        M::fields(defaults, [&]<class T>(const T& member, const Field& field) { made.add(field, &member, &member_type<T>); });
        made.copy = [](void* to, const void* from) { new (to) M(*static_cast<const M*>(from)); };
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
