#pragma once
#include "bind.hpp"

/// Calls of verbs from Python, taken as they come: what does not fit is refused in one line, where nanobind lists every overload.
namespace strainwave::host {

/// An argument of a verb as its signature tells it: name, type, and the value it has if it is not given, in Python's words. One
/// named "*" is none: those after it are given by name alone.
struct Accepted {
    const char* name;
    const char* type;
    const char* otherwise = "";
};

/// "def verb(self, name: type = value, ...) -> result"
inline const char* signature(const char* verb, const std::vector<Accepted>& accepted, const std::string& result) {
    std::string text = std::string("def ") + verb + "(self";
    for (const Accepted& one : accepted) {
        text += std::string(", ") + one.name;
        if (*one.type) text += std::string(": ") + one.type;
        if (*one.otherwise) text += std::string(" = ") + one.otherwise;
    }
    return kept(text + ") -> " + result);
}

inline void check_finite(double x, const char* name) {
    if (!std::isfinite(x)) throw nb::value_error((std::string(name) + " = " + shortest(x) + " is not finite").c_str());
}

/// What a verb was called with.
class Call {
    const std::string& verb;
    const std::vector<Accepted>& accepted;
    std::vector<nb::object> given;

public:
    Call(const std::string& verb_, const std::vector<Accepted>& accepted_, const nb::args& unnamed, const nb::kwargs& named)
        : verb(verb_), accepted(accepted_), given(accepted_.size()) {
        std::size_t count = 0;
        for (nb::handle value : unnamed) {
            if (count == accepted.size() || is_mark(accepted[count]))
                throw nb::type_error((verb + " takes " + (count == 0 ? "nothing" : std::to_string(count) + " at most") +
                                      " without a name, not " + std::to_string(unnamed.size()) + " arguments; it takes " +
                                      all_names())
                                         .c_str());
            given[count++] = nb::borrow(value);
        }
        for (auto [key, value] : named) {
            const std::size_t place = place_of(nb::cast<std::string>(key));
            if (place == accepted.size())
                throw nb::type_error((verb + " has no argument " + shortened(key) + "; it takes " + all_names()).c_str());
            if (given[place].is_valid()) throw nb::type_error((verb + " is given " + shortened(key) + " twice").c_str());
            given[place] = nb::borrow(value);
        }
        for (std::size_t i = 0; i < accepted.size(); ++i)
            if (!given[i].is_valid() && !*accepted[i].otherwise && !is_mark(accepted[i]))
                throw nb::type_error((verb + " needs " + accepted[i].name + "; it takes " + all_names()).c_str());
    }

    /// What was given, or the value that stands for it.
    nb::object operator[](const char* name) const {
        const std::size_t place = place_of(name);
        if (given[place].is_valid()) return given[place];
        return nb::float_(std::stod(accepted[place].otherwise));
    }

    /// A number, finite or not.
    double real(const char* name) const {
        const nb::object value = (*this)[name];
        double x = 0.0;
        if (!to_number(value, x)) refuse_type(name, "a number", value);
        return x;
    }
    double number(const char* name) const {
        const double x = real(name);
        check_finite(x, name);
        return x;
    }
    int whole(const char* name) const {
        const nb::object value = (*this)[name];
        const double x = number(name);
        if (x != std::floor(x)) refuse_type(name, "a whole number", value);
        return int(clip(x, -2147483648.0, 2147483647.0));
    }
    /// A described struct, such as a state; as it is by default if it was not given.
    template <class T>
    T part(const char* name) const {
        const nb::object& value = given[place_of(name)];
        if (!value.is_valid()) return {};
        if (!is_made<T>(value)) refuse_type(name, "a " + python_type<T>(false), value);
        return nb::cast<T>(value);
    }

private:
    static bool is_mark(const Accepted& one) { return *one.name == '*'; }

    std::size_t place_of(const std::string& name) const {
        std::size_t place = 0;
        while (place < accepted.size() && (is_mark(accepted[place]) || accepted[place].name != name)) ++place;
        return place;
    }
    std::string all_names() const {
        std::string names;
        for (const Accepted& one : accepted)
            if (!is_mark(one)) names += (names.empty() ? "" : ", ") + std::string(one.name);
        return names.empty() ? "no argument" : names;
    }
    [[noreturn]] void refuse_type(const char* name, const std::string& wanted, nb::handle value) const {
        throw nb::type_error((verb + ": " + name + " must be " + wanted + ", not " + shortened(value)).c_str());
    }
};

/// Binds a verb of a model: f(model, call).
template <class M, class F>
void verb(nb::class_<M>& c, const char* name, const std::vector<Accepted>& accepted, const std::string& result, const char* doc,
          F f) {
    const std::string full = nb::cast<std::string>(c.attr("name")) + "." + name;
    c.def(
        name,
        [f, full, accepted](const M& self, const nb::args& unnamed, const nb::kwargs& named) {
            return f(self, Call(full, accepted, unnamed, named));
        },
        nb::sig(signature(name, accepted, result)), doc);
}

/// Lets Ctrl-C through now and then, in step `i` of a loop.
inline void let_interrupt(std::size_t i) {
    if (i % 256 == 0 && PyErr_CheckSignals() != 0) throw nb::python_error();
}

}  // namespace strainwave::host
