#include "members.hpp"

#include <span>
#include <unordered_map>

namespace strainwave::host {

bool Reader::text_to_number(nb::handle value, const Field& field, const std::string& name, double& x) const {
    if (!nb::isinstance<nb::str>(value) || !has_unit(field)) return false;
    x = nb::cast<double>(nb::module_::import_("strainwave.arguments").attr("number")(owner + "." + name, value, field.unit));
    return true;
}

void Description::add(const Field& field, const void* member, const MemberType* type) {
    members.push_back({field, static_cast<const char*>(member) - static_cast<const char*>(defaults), type});
}

bool Description::is_made(nb::handle value) const {
    return PyObject_TypeCheck(value.ptr(), reinterpret_cast<PyTypeObject*>(python_type().ptr())) && nb::inst_ready(value);
}

nb::object Description::cast(const void* model) const {
    nb::object made = nb::inst_alloc(python_type());
    copy(nb::inst_ptr<void>(made), model);
    nb::inst_mark_ready(made);
    return made;
}

nb::object Member::value(const void* model) const {
    if (!type->part) return type->to_python(in(model));
    const PartOf part = type->part(in(model));
    return part.description->cast(part.model);
}

void Member::read(void* model, nb::handle value, const Reader& reader) const {
    if (!type->part) return type->read(in(model), value, reader, field);
    std::string names;
    for (const Alternative& one : std::span(type->alternatives, type->alternative_count)) {
        const Description& description = one.description();
        if (description.is_made(value)) return one.assign(in(model), nb::inst_ptr<void>(value));
        names += (names.empty() ? "" : ", ") + std::string(description.python_name);
    }
    reader.refuse_type(field, (type->chosen ? "one of " : "a ") + names, value);
}

std::string Member::python_type(bool argument) const {
    if (!type->part) return type->python_type(field, argument);
    std::string names;
    for (const Alternative& one : std::span(type->alternatives, type->alternative_count))
        names += (names.empty() ? "" : " | ") + qualified(one.description());
    return names;
}

nb::object Member::options() const {
    if (!type->part) return type->options();
    if (!type->chosen) return nb::none();
    nb::dict models;
    for (const Alternative& one : std::span(type->alternatives, type->alternative_count))
        models[one.description().name.c_str()] = one.description().python_type();
    return models;
}

namespace {

/// The names of all members, for messages.
std::string names_of(const Description& description) {
    std::string names;
    for (const Member& member : description.members) names += (names.empty() ? "" : ", ") + std::string(member.field.name);
    return names;
}

/// Sets the members that `values` names; an unknown name is refused.
void set_members(void* model, const nb::kwargs& values, const Description& description) {
    const Reader reader{description.name};
    nb::dict unknown(values);
    for (const Member& member : description.members) {
        if (!values.contains(member.field.name)) continue;
        member.read(model, values[member.field.name], reader);
        nb::del(unknown[member.field.name]);
    }
    for (auto [key, value] : unknown)
        throw nb::type_error(
            (description.name + " has no parameter " + shortened(key) + "; it has " + names_of(description)).c_str());
}

void check_relations(const void* model, const Description& description) {
    if (const std::string problem = description.problem(model); !problem.empty()) throw nb::value_error(problem.c_str());
}

/// Adds the values of members that follow a given one; returns the names of those that are required and not given.
std::string complete(nb::kwargs& values, const Description& description) {
    std::string missing;
    for (const auto& [field, offset, type] : description.members) {
        if (values.contains(field.name)) continue;
        if (field.required) missing += (missing.empty() ? "" : ", ") + std::string(field.name);
        if (field.follows && values.contains(field.follows)) values[field.name] = values[field.follows];
    }
    return missing;
}

/// Refuses parameters given by place, which nobody could read.
void check_named(const nb::args& unnamed, const Description& description) {
    if (unnamed.size() == 0) return;
    throw nb::type_error((description.name + " takes its parameters by name, not " + shortened(unnamed[0]) + " alone; it has " +
                          names_of(description))
                             .c_str());
}

/// The members as Python sees them, by name.
nb::dict values_of(const void* model, const Description& description) {
    nb::dict values;
    for (const Member& member : description.members) values[member.field.name] = member.value(model);
    return values;
}

std::string represented(const void* model, const Description& description) {
    std::string text;
    for (const Member& member : description.members)
        text += (text.empty() ? "" : ", ") + std::string(member.field.name) + "=" + text_of(member.value(model));
    return std::string(description.python_name) + "(" + text + ")";
}

bool same(const void* one, const void* other, const Description& description) {
    return parts_of(description, one) == parts_of(description, other);
}

/// "def head(self, *, name: type = ..., ...) -> result"; required members have no value by default where a model is made.
const char* signature(const std::string& head, const std::string& result, bool makes, const Description& description) {
    std::string text = "def " + head + (makes ? "(self" : "(self, changes: dict[str, typing.Any] = ..., /");
    if (!description.members.empty()) text += ", *";
    for (const Member& member : description.members)
        text += std::string(", ") + member.field.name + ": " + member.python_type(true) +
                (makes && member.field.required ? "" : " = ...");
    return kept(text + ") -> " + result);
}

/// Description of each member: name, unit, doc, limits (None: no limit) and whether the lower one is open, its kind, whether its
/// numbers are whole, and what it
/// may be chosen from; whether it is required, whether a file may leave it out, the member it follows if it is not given, and its
/// value by default: an order of magnitude where that is not used.
nb::tuple schema(const Description& description) {
    nb::list list;
    for (const Member& member : description.members) {
        const Field& field = member.field;
        nb::dict entry;
        entry["name"] = field.name;
        entry["unit"] = field.unit;
        entry["doc"] = field.doc;
        entry["min"] = field.min <= -unbounded ? nb::none() : nb::object(nb::float_(field.min == smallest ? 0.0 : field.min));
        entry["max"] = field.max >= unbounded ? nb::none() : nb::object(nb::float_(field.max));
        entry["kind"] = member.kind();
        entry["whole"] = member.is_whole();
        entry["open"] = field.min == smallest;
        entry["options"] = member.options();
        entry["required"] = field.required;
        entry["optional"] = field.optional;
        entry["follows"] = field.follows ? nb::object(nb::str(field.follows)) : nb::none();
        entry["default"] = member.value(description.defaults);
        list.append(entry);
    }
    return nb::tuple(list);
}

}  // namespace

std::string qualified(const Description& description) { return qualified(description.python_type()); }

std::string qualified(nb::handle type) {
    return nb::cast<std::string>(type.attr("__module__")) + "." + nb::cast<std::string>(type.attr("__qualname__"));
}

namespace {

/// Place of a member in a set of parameters.
struct Path {
    const Path* outer;
    const char* name;

    std::string text() const { return outer ? outer->text() + outer->name + "." : ""; }
};

/// Calls visit(path, member, where it lies) for each member of a model and of its parts that is none itself, and law(index) for
/// each law chosen, in order.
template <class Visit, class Law>
void walk(const Description& description, const void* model, const Visit& visit, const Law& law, const Path* outer = nullptr) {
    for (const Member& member : description.members) {
        const Path path{outer, member.field.name};
        if (!member.type->part) {
            visit(path, member, member.in(model));
            continue;
        }
        const PartOf part = member.type->part(member.in(model));
        if (part.law >= 0) law(part.law);
        walk(*part.description, part.model, visit, law, &path);
    }
}
constexpr auto any_law = [](int) {};

double number_of(const Member& member, const void* at, int element) { return *member.type->number(const_cast<void*>(at), element); }

}  // namespace

Parts parts_of(const Description& description, const void* model) {
    Parts parts;
    const auto visit = [&](const Path&, const Member& member, const void* at) {
        const int count = member.type->count(at);
        if (member.type->counted || !member.type->number) parts.shape.push_back(count);
        if (member.type->number)
            for (int i = 0; i < count; ++i) parts.numbers.push_back(number_of(member, at, i));
    };
    walk(description, model, visit, [&](int law) { parts.laws.push_back(law); });
    return parts;
}

std::vector<Parameter> parameters_of(const Description& description, const void* model) {
    std::vector<Parameter> list;
    const auto visit = [&](const Path& path, const Member& member, const void* at) {
        if (!member.type->number) return;
        const std::string name = path.text() + member.field.name;
        const bool several = std::string_view(member.type->kind) == "sequence";
        for (int i = 0; i < member.type->count(at); ++i)
            list.push_back({several ? name + "[" + std::to_string(i) + "]" : name, member.field, number_of(member, at, i)});
    };
    walk(description, model, visit, any_law);
    return list;
}

std::string problem_of(const Description& description, const void* model) {
    std::string found = description.problem(model);
    for (const Member& member : description.members) {
        if (!found.empty()) break;
        if (!member.type->part) continue;
        const PartOf part = member.type->part(member.in(model));
        found = problem_of(*part.description, part.model);
    }
    return found;
}

void set_numbers(const Description& description, void* model, const double* numbers) {
    const auto visit = [&](const Path&, const Member& member, const void* at) {
        if (!member.type->number) return;
        for (int i = 0; i < member.type->count(at); ++i) *member.type->number(const_cast<void*>(at), i) = *numbers++;
    };
    walk(description, model, visit, any_law);
}

nb::object with_numbers(const void* model, const Description& description, const std::vector<double>& numbers) {
    if (numbers.size() != parts_of(description, model).numbers.size())
        throw nb::value_error("the count of numbers must be that of the parameters of the model");
    nb::object other = description.cast(model);  // Python's alone until it is handed over
    void* const copy = nb::inst_ptr<void>(other);
    set_numbers(description, copy, numbers.data());
    const std::string problem = problem_of(description, copy);
    if (!problem.empty()) throw nb::value_error(problem.c_str());
    return other;
}

void check_passivity(const Condition<double>& rule, const char* name) {
    if (rule.left >= rule.right) return;
    const std::string text = std::string(name) + " can create energy: " + rule.left_name + " = " + with_unit(rule.left, rule.unit) +
                             " must be at least " + rule.right_name + " = " + with_unit(rule.right, rule.unit);
    if (PyErr_WarnEx(nb::module_::import_("strainwave._core").attr("PassivityWarning").ptr(), text.c_str(), 1) < 0)
        throw nb::python_error();
}

const void* model_in(nb::handle object, const Description& description) {
    if (!description.is_made(object))
        throw nb::type_error(("this needs a " + std::string(description.python_name) + ", not " + shortened(object)).c_str());
    return nb::inst_ptr<void>(object);
}

std::string documentation(const Description& description) {
    std::string text;
    if (description.doc) text = dedented(description.doc) + "\n\n";
    text += "Parameters\n----------\n";
    for (const Member& member : description.members) {
        const Field& field = member.field;
        text += std::string(field.name) + ": " + field.doc;
        if (has_unit(field)) text += std::string(" [") + field.unit + "]";
        if (member.type->numeric && (field.min > -unbounded || field.max < unbounded)) text += ", in " + limits(field);
        if (member.type->listed) text += ", one of " + text_of(member.options());
        text += field.required  ? "; required\n"
                : field.follows ? std::string("; default as ") + field.follows + "\n"
                                : "; default " + text_of(member.value(description.defaults)) + "\n";
    }
    text +=
        "\nRaises\n------\nTypeError: an unknown parameter, one of the wrong kind, or none where it is required\nValueError: a "
        "number that is not finite or "
        "out of its range\n";
    if (description.source) text += std::string("\nSource\n------\n") + description.source + "\n";
    return text;
}

namespace {

/// The descriptions of all structs that are bound, by their types.
std::unordered_map<PyObject*, const Description*>& bound() {
    static std::unordered_map<PyObject*, const Description*> all;
    return all;
}

}  // namespace

const Description& description_of(nb::handle object) {
    const auto found = bound().find(object.type().ptr());
    if (found == bound().end()) throw nb::type_error((shortened(object) + " is no model").c_str());
    return *found->second;
}

namespace {

/// Memory for the model of an object; a constructed model never changes.
void* unmade(nb::handle object, const Description& description) {
    const nb::handle type = description.python_type();
    if (!PyObject_TypeCheck(object.ptr(), reinterpret_cast<PyTypeObject*>(type.ptr())) || nb::inst_ready(object))
        throw nb::type_error((std::string(description.python_name) + " cannot be made of " + shortened(object)).c_str());
    return nb::inst_ptr<void>(object);
}

}  // namespace

void define_value(nb::handle type, const Description& description) {
    bound()[type.ptr()] = &description;
    const Description* const of = &description;
    const auto define = [&](const char* name, auto f, const auto&... extra) {
        nb::cpp_function_def(f, nb::scope(type), nb::name(name), nb::is_method(), extra...);
    };
    define(
        "__init__",
        [of](nb::handle self, const nb::args& unnamed, nb::kwargs values) {
            check_named(unnamed, *of);
            const std::string missing = complete(values, *of);
            void* const model = unmade(self, *of);
            of->copy(model, of->defaults);
            set_members(model, values, *of);
            if (!missing.empty()) throw nb::type_error((of->name + " needs " + missing + ": no default suits most gears").c_str());
            check_relations(model, *of);
            if (of->check_passivity) of->check_passivity(model);
            nb::inst_mark_ready(self);
        },
        nb::sig(signature("__init__", "None", true, description)));
    define(
        "replace",
        [of](nb::handle self, const nb::args& unnamed, const nb::kwargs& values) {
            const void* const from = model_in(self, *of);
            if (unnamed.size() == 1 && PyDict_Check(unnamed[0].ptr())) {
                const nb::object replaced = nb::module_::import_("strainwave.parameters").attr("replaced")(self, unnamed[0]);
                return values.size() == 0 ? replaced : nb::object(replaced.attr("replace")(**values));
            }
            check_named(unnamed, *of);
            nb::object other = of->cast(from);  // Python's alone until it is handed over
            void* const model = nb::inst_ptr<void>(other);
            set_members(model, values, *of);
            check_relations(model, *of);
            if (of->check_passivity) of->check_passivity(model);
            return other;
        },
        nb::sig(signature("replace", qualified(type), false, description)),
        "Return the model with the named parameters changed. A dictionary names them by their paths: {\"friction_input.viscous\": "
        "1e-4}.");
    const nb::object property = nb::module_::import_("builtins").attr("property");
    for (const Member& member : description.members) {
        const Field& field = member.field;
        const std::string unit = has_unit(field) ? std::string(" [") + field.unit + "]" : "";
        const nb::object getter = nb::cpp_function(
            [of, at = &member](nb::handle self) { return at->value(model_in(self, *of)); }, nb::name(field.name), nb::scope(type),
            nb::is_method(), nb::is_getter(),
            nb::sig(kept(std::string("def ") + field.name + "(self) -> " + member.python_type(false))), kept(field.doc + unit));
        nb::setattr(type, field.name, property(getter));
    }
    define("__repr__", [of](nb::handle self) { return represented(model_in(self, *of), *of); });
    define(
        "__eq__",
        [of](nb::handle self, nb::handle other) {
            return nb::isinstance(other, of->python_type()) && nb::inst_ready(other) &&
                   same(model_in(self, *of), model_in(other, *of), *of);
        },
        nb::arg("other").none(), nb::sig("def __eq__(self, other: object, /) -> bool"));
    define("__hash__", [of](nb::handle self) { return nb::hash(nb::tuple(values_of(model_in(self, *of), *of).values())); });
    define(
        "__getstate__", [of](nb::handle self) { return values_of(model_in(self, *of), *of); },
        nb::sig("def __getstate__(self) -> dict[str, object]"));
    define(
        "__setstate__",
        [of](nb::handle self, const nb::dict& state) {
            void* const model = unmade(self, *of);
            of->copy(model, of->defaults);
            set_members(model, nb::borrow<nb::kwargs>(state), *of);
            check_relations(model, *of);
            nb::inst_mark_ready(self);
        },
        nb::sig("def __setstate__(self, state: dict[str, object], /) -> None"));
    define(
        "__reduce__",
        [](nb::handle self) {  // as every protocol of pickle can write it
            return nb::make_tuple(nb::module_::import_("copyreg").attr("__newobj__"), nb::make_tuple(self.type()),
                                  self.attr("__getstate__")());
        },
        nb::sig("def __reduce__(self) -> tuple[typing.Any, ...]"));
    type.attr("name") = description.name;
    if (description.source) type.attr("source") = description.source;
    type.attr("fields") = schema(description);
}

}  // namespace strainwave::host
