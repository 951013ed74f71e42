/// Prints how many sums, products and quotients a step of the reference drive takes, and how many this processor does at most
/// [1e9/s], in multiply-adds of its widest registers.
#include <strainwave/drive.hpp>
#include <strainwave/integrate.hpp>
#include <strainwave/models.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>

namespace counting {

long operations = 0;

/// A number that counts what it is part of. Comparisons and choices are free.
struct Counted {
    double value = 0.0;

    Counted() = default;
    constexpr Counted(double x) : value(x) {}
};

// Sums, products and quotients of strainwave's own exp, and of its sine and cosine, counted in scalar/elementary.hpp: reduction and
// polynomials, 8 + 14, and 10 + 53. Signs, bits and table look-ups are free.
constexpr long of_exp = 22, of_sincos = 63;

Counted counted(double x, long more = 1) {
    operations += more;
    return x;
}
Counted operator+(const Counted& a, const Counted& b) { return counted(a.value + b.value); }
Counted operator-(const Counted& a, const Counted& b) { return counted(a.value - b.value); }
Counted operator*(const Counted& a, const Counted& b) { return counted(a.value * b.value); }
Counted operator/(const Counted& a, const Counted& b) { return counted(a.value / b.value); }
Counted operator-(const Counted& a) { return -a.value; }
bool operator<(const Counted& a, const Counted& b) { return a.value < b.value; }
bool operator>(const Counted& a, const Counted& b) { return a.value > b.value; }
bool operator>=(const Counted& a, const Counted& b) { return a.value >= b.value; }
bool operator==(const Counted& a, const Counted& b) { return a.value == b.value; }
Counted select(bool mask, const Counted& a, const Counted& b) { return mask ? a : b; }
Counted abs(const Counted& x) { return std::abs(x.value); }
Counted rint(const Counted& x) { return std::rint(x.value); }
Counted sqrt(const Counted& x) { return counted(std::sqrt(x.value)); }
Counted log(const Counted& x) { return counted(std::log(x.value)); }
Counted atan(const Counted& x) { return counted(std::atan(x.value)); }
Counted exp(const Counted& x) { return counted(std::exp(x.value), of_exp); }
Counted sin(const Counted& x) { return counted(std::sin(x.value), of_sincos); }
Counted cos(const Counted& x) { return counted(std::cos(x.value), of_sincos); }
strainwave::SinCos<Counted> sincos(const Counted& x) {
    operations += of_sincos;
    return {std::sin(x.value), std::cos(x.value)};
}

}  // namespace counting

namespace {

using namespace strainwave;
using S = counting::Counted;

/// The reference drive of benchmarks/reference_drive.py.
auto reference_drive() {
    Drive<S, control::PID<S>, motor::DC<S>,
          Gear<S, kinematics::PlainRatio<S>, kinematic_error::Fourier<S>, kinematic_error::Stochastic<S>, stiffness::Cubic<S>,
               hysteresis::MaxwellSlip<S>, friction::LuGre<S>, friction::Viscous<S>, friction::Viscous<S>,
               softening::ThermalSoftening<S>>,
          load::Pendulum<S>, Sensors<S, sensor::Ideal<S>>>
        drive{};
#include "reference_drive.inc"  // its numbers, written by peak.py
    return drive.compile();
}

/// Operations of one of a second of steps, on average.
double operations_of_a_step() {
    constexpr int steps = 5000;
    constexpr double dt = 2e-4;
    const auto drive = reference_drive();
    const auto input = [](double t) {
        const double w = 2.0 * pi * COMMAND_FREQUENCY;
        const double angle = COMMAND_SLOPE * t + COMMAND_AMPLITUDE * std::sin(w * t);
        return Input<S>{angle, COMMAND_SLOPE + COMMAND_AMPLITUDE * w * std::cos(w * t)};
    };
    auto at = drive.evaluate(drive.rest(), input(0.0));
    counting::operations = 0;
    for (int i = 0; i < steps; ++i) {
        const double t = dt * i;
        const Interval<Input<S>> u{input(t), input(t + 0.5 * dt), input(t + dt)};
        at = drive.evaluate(integrate::exponential_step(drive, at, u, S(dt)), u.end);
    }
    return double(counting::operations) / steps;
}

/// The most that one core does, in chains of multiply-adds enough to fill its units.
double most_operations() {
#if defined(__AVX512F__)
    constexpr int lanes = 8;
#elif defined(__AVX__)
    constexpr int lanes = 4;
#else
    constexpr int lanes = 2;
#endif
    typedef double Lanes __attribute__((vector_size(lanes * sizeof(double))));
    constexpr int chains = 12, rounds = 1 << 22;
    double best = 0.0;
    for (int attempt = 0; attempt < 10; ++attempt) {
        Lanes sum[chains];
        for (int k = 0; k < chains; ++k) sum[k] = Lanes{} + k;  // all different: equal chains would be made one
        const Lanes factor = Lanes{} + 0.999999, term = Lanes{} + 1e-6;
        const auto start = std::chrono::steady_clock::now();
        for (int i = 0; i < rounds; ++i)
            for (int k = 0; k < chains; ++k) sum[k] = sum[k] * factor + term;
        const double taken = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        volatile double kept = 0.0;
        for (const Lanes& lane : sum) kept = kept + lane[0];
        best = std::max(best, 2.0 * lanes * chains * rounds / taken);
    }
    return best;
}

}  // namespace

int main() { std::printf("%.1f %.3f\n", operations_of_a_step(), 1e-9 * most_operations()); }
