#include "call.hpp"

namespace strainwave::host {

namespace {

bool is_mark(const Accepted& one) { return *one.name == '*'; }

/// "def verb(self, name: type = value, ...) -> result"
const char* signature(const char* verb, const std::vector<Accepted>& accepted, const std::string& result) {
    std::string text = std::string("def ") + verb + "(self";
    for (const Accepted& one : accepted) {
        text += std::string(", ") + one.name;
        if (*one.type) text += std::string(": ") + one.type;
        if (*one.otherwise) text += std::string(" = ") + one.otherwise;
    }
    return kept(text + ") -> " + result);
}

}  // namespace

void check_finite(double x, const char* name) {
    if (!std::isfinite(x)) throw nb::value_error((std::string(name) + " = " + shortest(x) + " is not finite").c_str());
}

Call::Call(const std::string& verb_, const std::vector<Accepted>& accepted_, const nb::args& unnamed, const nb::kwargs& named)
    : verb(verb_), accepted(accepted_), given(accepted_.size()) {
    std::size_t count = 0;
    for (nb::handle value : unnamed) {
        if (count == accepted.size() || is_mark(accepted[count]))
            throw nb::type_error((verb + " takes " + (count == 0 ? "nothing" : std::to_string(count) + " at most") +
                                  " without a name, not " + std::to_string(unnamed.size()) + " arguments; it takes " + all_names())
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

nb::object Call::operator[](const char* name) const {
    const std::size_t place = place_of(name);
    if (given[place].is_valid()) return given[place];
    return nb::float_(std::stod(accepted[place].otherwise));
}

double Call::real(const char* name) const {
    const nb::object value = (*this)[name];
    double x = 0.0;
    if (!to_number(value, x)) refuse_type(name, "a number", value);
    return x;
}

double Call::number(const char* name) const {
    const double x = real(name);
    check_finite(x, name);
    return x;
}

int Call::whole(const char* name) const {
    const nb::object value = (*this)[name];
    const double x = number(name);
    if (x != std::floor(x)) refuse_type(name, "a whole number", value);
    return int(clip(x, -2147483648.0, 2147483647.0));
}

nb::object Call::optional(const char* name, const Description& description) const {
    const nb::object& value = given[place_of(name)];
    if (!value.is_valid()) return {};
    if (!description.is_made(value)) refuse_type(name, "a " + qualified(description), value);
    return value;
}

std::size_t Call::place_of(const std::string& name) const {
    std::size_t place = 0;
    while (place < accepted.size() && (is_mark(accepted[place]) || accepted[place].name != name)) ++place;
    return place;
}

std::string Call::all_names() const {
    std::string names;
    for (const Accepted& one : accepted)
        if (!is_mark(one)) names += (names.empty() ? "" : ", ") + std::string(one.name);
    return names.empty() ? "no argument" : names;
}

void Call::refuse_type(const char* name, const std::string& wanted, nb::handle value) const {
    throw nb::type_error((verb + ": " + name + " must be " + wanted + ", not " + shortened(value)).c_str());
}

void define_verb(nb::handle type, const Description& description, const char* name, const std::vector<Accepted>& accepted,
                 const std::string& result, const char* doc, std::function<nb::object(const void*, const Call&)> f) {
    const std::string full = description.name + "." + name;
    nb::cpp_function_def(
        [f = std::move(f), of = &description, full, accepted](nb::handle self, const nb::args& unnamed, const nb::kwargs& named) {
            return f(model_in(self, *of), Call(full, accepted, unnamed, named));
        },
        nb::scope(type), nb::name(name), nb::is_method(), nb::sig(signature(name, accepted, result)), doc);
}

void define_function(nb::handle type, const Description& description, const char* name, const std::vector<Accepted>& accepted,
                     const char* doc, std::function<double(const void*, const double*)> f) {
    const auto value = [f = std::move(f), of = &description, accepted](nb::handle self, const auto&... x) {
        const double numbers[]{x...};
        for (std::size_t i = 0; i < accepted.size(); ++i) check_finite(numbers[i], accepted[i].name);
        return f(model_in(self, *of), numbers);
    };
    const auto define = [&](auto call, const auto&... arguments) {
        nb::cpp_function_def(call, nb::scope(type), nb::name(name), nb::is_method(), arguments...,
                             nb::sig(signature(name, accepted, "float")), doc);
    };
    const auto named = [&](std::size_t i) { return nb::arg(accepted[i].name) = std::stod(accepted[i].otherwise); };
    const auto one = [value](nb::handle self, double a) { return value(self, a); };
    const auto three = [value](nb::handle self, double a, double b, double c) { return value(self, a, b, c); };
    const auto four = [value](nb::handle self, double a, double b, double c, double d) { return value(self, a, b, c, d); };
    auto first = nb::arg(accepted[0].name).noconvert();
    if (accepted.size() == 1)
        define(one, first);
    else if (accepted.size() == 3)
        define(three, first, named(1), named(2));
    else if (*accepted[0].otherwise)
        define(four, first = std::stod(accepted[0].otherwise), named(1), named(2), named(3));
    else
        define(four, first, named(1), named(2), named(3));
}

void define_property(nb::handle type, const Description& description, const char* name, const char* result, const char* doc,
                     std::function<nb::object(const void*)> f) {
    const nb::object getter = nb::cpp_function(
        [f = std::move(f), of = &description](nb::handle self) { return f(model_in(self, *of)); }, nb::name(name), nb::scope(type),
        nb::is_method(), nb::is_getter(), nb::sig(kept(std::string("def ") + name + "(self) -> " + result)), doc);
    nb::setattr(type, name, nb::module_::import_("builtins").attr("property")(getter));
}

}  // namespace strainwave::host
