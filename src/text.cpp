#include "text.hpp"

#include <cstring>
#include <memory>
#include <vector>

namespace strainwave::host {

std::string shortest(double x) {
    const std::unique_ptr<char, void (*)(void*)> text(PyOS_double_to_string(x, 'r', 0, 0, nullptr), PyMem_Free);
    return text.get();
}

std::string with_unit(double x, const char* unit) {
    return shortest(x) + (std::strcmp(unit, "1") == 0 ? "" : std::string(" ") + unit);
}

bool has_unit(const Field& field) { return *field.unit && std::strcmp(field.unit, "1") != 0; }

std::string limits(const Field& field) {
    const bool open_low = field.min <= -unbounded, open_high = field.max >= unbounded, positive = field.min == smallest;
    return (open_low   ? "(-inf"
            : positive ? "(0"
                       : "[" + shortest(field.min)) +
           ", " + (open_high ? "inf)" : shortest(field.max) + "]");
}

std::string outside(const Domain<double>& domain) {
    return std::string(domain.name) + " = " + with_unit(domain.value, domain.unit) + " lies outside of [" + shortest(domain.low) +
           ", " + with_unit(domain.high, "1") + "]" + (std::strcmp(domain.unit, "1") == 0 ? "" : " " + std::string(domain.unit)) +
           (*domain.remedy ? std::string("; ") + domain.remedy : "");
}

std::string text_of(nb::handle value) { return nb::cast<std::string>(nb::repr(value)); }

std::string shortened(nb::handle value) {
    if (nb::inst_check(value) && !nb::inst_ready(value))
        return "a " + nb::cast<std::string>(value.type().attr("__name__")) + " that was never made";
    return nb::cast<std::string>(nb::module_::import_("reprlib").attr("repr")(value));
}

std::string dedented(const char* text) {
    nb::object clean = nb::module_::import_("inspect").attr("cleandoc")(text);
    return nb::cast<std::string>(clean);
}

const char* kept(std::string text) {
    static std::vector<std::unique_ptr<std::string>> texts;
    texts.push_back(std::make_unique<std::string>(std::move(text)));
    return texts.back()->c_str();
}

const char* name_of_template(const std::string& signature) {
    const std::size_t end = signature.find("<double"), start = signature.rfind("::", end) + 2;
    return kept(signature.substr(start, end - start));
}

}  // namespace strainwave::host
