#pragma once
#include "call.hpp"
#include "general/part.hpp"

/// Functions of the laws in Python. What the laws of a family have in common is asked of the general drive's part, made of
/// one law: compiled once, not once for each law.
namespace strainwave::host {

using Argument = nb::ndarray<const double, nb::c_contig>;

/// Numbers from Python as an array, refused unless all are finite.
Argument numbers(nb::handle values, const char* name);
Argument path_of(nb::handle values, const char* name);
/// A path no wider than numbers reach, with room for some times as much in sums along it.
Argument steps_of(nb::handle values, const char* name, const char* unit);
/// A new array of the same shape, and its numbers.
std::pair<Values, double*> like(const Argument& model);

#define SW_NUMBER_OR "float | collections.abc.Sequence[float] | " SW_ARRAY
#define SW_NUMBERS "collections.abc.Sequence[float] | " SW_ARRAY

/// An angle in turns and rest. One too large to resolve its turn stands where it would if turns were of 2 pi as rounded; beyond
/// 1e300 turns no two are distinct.
Angle<double> turned(double angle);

/// Refuses an argument outside of where a law is valid.
void check_domain(std::string_view law, const Domain<double>& domain);

/// A part of the general drive by itself.
template <class Part>
struct SingleLaw {
    general::OwnedLaws laws;
    Part part;

    /// Law number `law` of its family.
    SingleLaw(const Description& description, const void* model, int law) {
        const Parts parts = parts_of(description, model);
        std::vector<int> chosen{law};
        chosen.insert(chosen.end(), parts.laws.begin(), parts.laws.end());
        kernel::Reader<double> from{chosen.data(), parts.shape.data(), parts.numbers.data(), &laws};
        part.read(from);
    }
    template <class S, class... Law>
    explicit SingleLaw(const Choice<S, Law...>& choice)
        : SingleLaw(choice.visit([&]<class Chosen>(const Chosen& law) {
              return SingleLaw(description_of<Chosen>(), &law, int(choice.model.index()));
          })) {}
};

/// A law as Python binds it, while its verbs are added: which of its family it is, and the struct of its state, null if it has
/// none.
struct BoundLaw {
    nb::handle type;
    const Description& description;
    int law;
    const Description* state = nullptr;
    bool stores = false;  ///< whether it knows the energy that it stores
};

void stiffness_verbs(const BoundLaw& law);
void hysteresis_verbs(const BoundLaw& law);
void friction_verbs(const BoundLaw& law);
void error_verbs(const BoundLaw& law);
void noise_verbs(const BoundLaw& law);
void variation_verbs(const BoundLaw& law);
void material_verbs(const BoundLaw& law);
void feedforward_verbs(const BoundLaw& law);

}  // namespace strainwave::host
