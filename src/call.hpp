#pragma once
#include <functional>

#include "arrays.hpp"
#include "bind.hpp"

/// Calls of verbs from Python with any arguments: a wrong one is an error of one line, while nanobind lists every overload.
namespace strainwave::host {

/// An argument of a verb as its signature lists it: name, type, and the value it has if it is not given, in Python's words. One
/// named "*" is none: those after it are given by name alone.
struct Accepted {
    const char* name;
    const char* type;
    const char* otherwise = "";
};

void check_finite(double x, const char* name);

/// Arguments of a call of a verb.
class Call {
    const std::string& verb;
    const std::vector<Accepted>& accepted;
    std::vector<nb::object> given;

public:
    Call(const std::string& verb_, const std::vector<Accepted>& accepted_, const nb::args& unnamed, const nb::kwargs& named);

    /// The given value, or the default.
    nb::object operator[](const char* name) const;
    /// A number, finite or not.
    double real(const char* name) const;
    double number(const char* name) const;
    int whole(const char* name) const;
    /// A described struct that may be left out; then none.
    nb::object optional(const char* name, const Description& description) const;
    /// A described struct, such as a state; as it is by default if it was not given.
    template <class T>
    T part(const char* name) const {
        const nb::object& value = given[place_of(name)];
        if (!value.is_valid()) return {};
        const Description& description = description_of<T>();
        if (!description.is_made(value)) refuse_type(name, "a " + qualified(description), value);
        return *nb::inst_ptr<T>(value);
    }

private:
    std::size_t place_of(const std::string& name) const;
    std::string all_names() const;
    [[noreturn]] void refuse_type(const char* name, const std::string& wanted, nb::handle value) const;
};

// Functions of a type that get the model as a pointer, so that only they are compiled for each type.

/// f(model, call).
void define_verb(nb::handle type, const Description& description, const char* name, const std::vector<Accepted>& accepted,
                 const std::string& result, const char* doc, std::function<nb::object(const void*, const Call&)> f);

/// f(model, numbers) of Python numbers only: the most frequent call, without any conversion.
void define_function(nb::handle type, const Description& description, const char* name, const std::vector<Accepted>& accepted,
                     const char* doc, std::function<double(const void*, const double*)> f);

/// f(model).
void define_property(nb::handle type, const Description& description, const char* name, const char* result, const char* doc,
                     std::function<nb::object(const void*)> f);

/// A model as Python binds it, while its verbs are added.
template <class M>
struct Bound {
    nb::class_<M> type;
    const Description& description;
};

/// Binds a verb of a model: f(model, call).
template <class M, class F>
void verb(const Bound<M>& bound, const char* name, const std::vector<Accepted>& accepted, const std::string& result,
          const char* doc, F f) {
    define_verb(bound.type, bound.description, name, accepted, result, doc, [f](const void* model, const Call& call) -> nb::object {
        const M& self = *static_cast<const M*>(model);
        if constexpr (std::is_void_v<decltype(f(self, call))>) {
            f(self, call);
            return nb::none();
        } else {
            return nb::cast(f(self, call));
        }
    });
}

template <class M, class F>
void property(const Bound<M>& bound, const char* name, const char* result, const char* doc, F f) {
    define_property(bound.type, bound.description, name, result, doc,
                    [f](const void* model) { return nb::cast(f(*static_cast<const M*>(model))); });
}

/// Lets Ctrl-C through now and then, in step `i` of a loop.
inline void let_interrupt(std::size_t i) {
    if (i % 256 == 0 && PyErr_CheckSignals() != 0) throw nb::python_error();
}

}  // namespace strainwave::host
