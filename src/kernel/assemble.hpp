#pragma once
#include <strainwave/compiled.hpp>
#include <strainwave/field.hpp>

#include "standard.hpp"

/// A drive put together from its parameters.
namespace strainwave::kernel {

/// A set of parameters taken apart: the laws chosen, the other whole numbers (counts, teeth, options), and the numbers. Sets with
/// equal laws have drives of one static type.
struct Set {
    const int* laws;
    const int* shape;
    const double* numbers;
    int count;  ///< of numbers
};

/// The unread rest of a set, its numbers as scalars S.
template <class S>
struct Reader {
    const int* laws;
    const int* shape;
    const S* numbers;
    void* owned_laws = nullptr;  ///< to which the general drive adds those that it chooses
};

/// Fills in a model, member by member. A part that chooses its law at run time reads itself.
template <class S>
struct Assemble {
    Reader<S>& from;

    template <class T>
    void operator()(T& member, const Field&) const {
        if constexpr (requires { member.read(from); }) {
            member.read(from);
        } else if constexpr (Described<T>) {
            T::fields(member, *this);
        } else if constexpr (requires { member.item; }) {
            if constexpr (requires { member.count; }) member.count = *from.shape++;
            for (int i = 0; i < member.size(); ++i) member[i] = *from.numbers++;
        } else if constexpr (std::is_same_v<T, S>) {
            member = *from.numbers++;
        } else {
            member = T(*from.shape++);
        }
    }
};

template <class M, class S>
M assembled(Reader<S>& from) {
    M model{};
    M::fields(model, Assemble<S>{from});
    return model;
}

}  // namespace strainwave::kernel
