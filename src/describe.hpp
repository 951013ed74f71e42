#pragma once
#include <charconv>
#include <string>
#include <vector>

#include <strainwave/condition.hpp>

#include "choice.hpp"
#include "kernel/assemble.hpp"

/// Table of the members of a described struct at run time: code that walks sets of parameters is compiled once.
namespace strainwave::host {

template <class T>
inline constexpr bool is_choice = false;
template <class S, class... Law>
inline constexpr bool is_choice<Choice<S, Law...>> = true;
template <class T>
inline constexpr bool is_sequence = false;
template <class T, int n>
inline constexpr bool is_sequence<Sequence<T, n>> = true;
template <class T, int n>
inline constexpr bool is_sequence<Counted<T, n>> = true;
template <class T>
inline constexpr bool is_array = false;
template <class T, int n>
inline constexpr bool is_array<Array<T, n>> = true;

struct Description;

/// A member that is itself described: which law it is, counted from 0, or -1 where there is no choice.
struct PartOf {
    const Description* description;
    const void* model;
    int law;
};

/// A set of parameters taken apart. Two sets with equal laws and shapes differ in numbers alone.
struct Parts {
    std::vector<int> laws, shape;
    std::vector<double> numbers;
    friend bool operator==(const Parts&, const Parts&) = default;

    kernel::Set set() const { return {laws.data(), shape.data(), numbers.data(), int(numbers.size())}; }
};

/// A number of a set: its path, field and value.
struct Parameter {
    std::string path;
    Field field;
    double value;
};

Parts parts_of(const Description& description, const void* model);
std::vector<Parameter> parameters_of(const Description& description, const void* model);
/// The first contradiction between the numbers of a model or of one of its parts; empty if there is none.
std::string problem_of(const Description& description, const void* model);
/// Puts other numbers, as many, in place of those of a model.
void set_numbers(const Description& description, void* model, const double* numbers);

/// The text of a contradiction between the numbers of a model; empty if there is none.
inline std::string text_of_problem(const char* problem) { return problem ? problem : ""; }
inline std::string text_of_problem(const Contradiction<double>& problem) {
    std::string text = text_of_problem(problem.text);
    std::size_t from = 0;
    for (const double number : {problem.first, problem.second}) {
        const std::size_t place = text.find("{}", from);
        if (place == std::string::npos) break;
        char digits[32];
        const auto end = std::to_chars(digits, digits + sizeof digits, number);
        text.replace(place, 2, digits, end.ptr - digits);
        from = place + (end.ptr - digits);
    }
    return text;
}
inline std::string problem_of(const char* model, const std::string& problem) {
    return problem.empty() ? problem : std::string(model) + ": " + problem;
}
template <class M>
std::string own_problem_of(const M& model) {
    if constexpr (requires { model.problem(); })
        return problem_of(M::name, text_of_problem(model.problem()));
    else
        return {};
}

}  // namespace strainwave::host
