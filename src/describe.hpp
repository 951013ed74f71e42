#pragma once
#include <strainwave/any.hpp>

#include <charconv>
#include <string>
#include <type_traits>
#include <vector>

/// A set of parameters taken apart into its numbers and put together again, in another scalar if need be.
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

/// What a set of parameters consists of: its numbers, and the whole numbers that say which number means what
/// (models chosen, element counts, teeth). Two sets with equal shapes differ in numbers alone.
struct Parts {
    std::vector<double> numbers;
    std::vector<int> shape;
    friend bool operator==(const Parts&, const Parts&) = default;
};

/// One number of a set: where it is, and what is known of it.
struct Parameter {
    std::string path;
    Field field;
    double value;
};

/// Visits a set of parameters number by number: number(path, value, field), structure(whole number).
template <class Number, class Structure>
struct Walk {
    Number number;
    Structure structure;
    std::string prefix{};

    template <class T>
    void operator()(const T& member, const Field& field) {
        const std::string path = prefix + field.name;
        if constexpr (is_choice<T>) {
            structure(int(member.model.index()));
            member.visit([&](const auto& law) { descend(law, path); });
        } else if constexpr (Described<T>) {
            descend(member, path);
        } else if constexpr (is_sequence<T> || is_array<T>) {
            if constexpr (is_sequence<T>) structure(member.count);
            for (int i = 0; i < member.size(); ++i) number(path + "[" + std::to_string(i) + "]", member[i], field);
        } else if constexpr (std::is_enum_v<T> || std::is_same_v<T, int>) {
            structure(int(member));
        } else {
            number(path, member, field);
        }
    }

private:
    template <class T>
    void descend(const T& part, const std::string& path) {
        Walk inner{number, structure, path + "."};
        T::fields(part, inner);
    }
};
template <class Number, class Structure>
Walk(Number, Structure) -> Walk<Number, Structure>;  // clang deduces none of an aggregate before version 17

template <class M>
Parts parts_of(const M& model) {
    Parts parts;
    const auto number = [&](const std::string&, double x, const Field&) { parts.numbers.push_back(x); };
    const auto structure = [&](int n) { parts.shape.push_back(n); };
    Walk walk{number, structure};
    M::fields(model, walk);
    return parts;
}

template <class M>
std::vector<Parameter> parameters_of(const M& model) {
    std::vector<Parameter> list;
    const auto number = [&](const std::string& path, double x, const Field& field) { list.push_back({path, field, x}); };
    const auto structure = [](int) {};
    Walk walk{number, structure};
    M::fields(model, walk);
    return list;
}

/// What a model says of a contradiction between its numbers; empty if there is none.
inline std::string told(const char* problem) { return problem ? problem : ""; }
inline std::string told(const Contradiction<double>& problem) {
    std::string text = told(problem.text);
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
template <class M>
std::string own_problem_of(const M& model) {
    if constexpr (requires { model.problem(); })
        if (const std::string problem = told(model.problem()); !problem.empty()) return std::string(M::name) + ": " + problem;
    return {};
}

/// What is wrong with how the numbers of a model, or of one of its parts, relate to each other; empty if nothing is.
template <class M>
std::string problem_of(const M& model) {
    std::string found = own_problem_of(model);
    const auto look = [&]<class T>(const T& member, const Field&) {
        if (!found.empty()) return;
        if constexpr (is_choice<T>)
            found = member.visit([](const auto& law) { return problem_of(law); });
        else if constexpr (Described<T>)
            found = problem_of(member);
    };
    M::fields(model, look);
    return found;
}

/// Puts a model together: next() gives its numbers in order, shape its whole numbers.
template <class S, class Next>
struct Assemble {
    Next& next;
    const int*& shape;

    template <class T>
    void operator()(T& member, const Field&) {
        if constexpr (is_choice<T>) {
            choose(member, *shape++);
        } else if constexpr (Described<T>) {
            T::fields(member, *this);
        } else if constexpr (is_sequence<T> || is_array<T>) {
            if constexpr (is_sequence<T>) member.count = *shape++;
            for (int i = 0; i < member.size(); ++i) member[i] = next();
        } else if constexpr (std::is_enum_v<T> || std::is_same_v<T, int>) {
            member = T(*shape++);
        } else {
            member = next();
        }
    }

private:
    template <int i = 0, class... Law>
    void choose(Choice<S, Law...>& choice, int index) {
        if constexpr (i < int(sizeof...(Law))) {
            if (index != i) return choose<i + 1>(choice, index);
            auto& law = choice.model.template emplace<i>();
            std::remove_reference_t<decltype(law)>::fields(law, *this);
        }
    }
};

/// A model of scalar S with this shape and the numbers that `number(i)` gives.
template <class M, class S, class Number>
M assembled(const std::vector<int>& shape, Number&& number) {
    M model{};
    int i = 0;
    auto next = [&]() -> S { return number(i++); };
    const int* at = shape.data();
    Assemble<S, decltype(next)> assemble{next, at};
    M::fields(model, assemble);
    return model;
}

}  // namespace strainwave::host
