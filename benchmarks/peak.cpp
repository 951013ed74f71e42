/// Prints how many sums, products and quotients a step of the reference drive takes, and how many this processor does at most
/// [1e9/s], in multiply-adds of its widest registers.
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

/// The reference drive; benchmarks/reference_drive.py says where its numbers are from.
auto reference_drive() {
    PositionDrive<
        S,
        Gear<S, kinematics::PlainRatio<S>, kinematic_error::Fourier<S>, kinematic_error::Stochastic<S>, stiffness::Cubic<S>,
             hysteresis::MaxwellSlip<S>, friction::LuGre<S>, friction::Viscous<S>, friction::Viscous<S>>,
        motor::DC<S>, control::PID<S>, load::Pendulum<S>>
        drive{};
    drive.motor.resistance = 0.5;
    drive.motor.inductance = 5e-4;
    drive.motor.torque_constant = drive.motor.back_emf = 0.1;
    drive.motor.inertia = 1e-4;
    drive.load.inertia = 0.5;
    drive.load.gravity_torque = 15.0;
    drive.control.proportional = 2.0;
    drive.control.derivative = 0.05;
    drive.control.limit = 48.0;
    drive.gear.kinematics.reduction = 100.0;
    drive.gear.stiffness.a1 = 1.2e4;
    drive.gear.stiffness.a3 = 1e9;
    drive.gear.damping = 10.0;
    auto& hysteresis = drive.gear.hysteresis;
    hysteresis.stiffness.count = hysteresis.breakaway.count = 8;
    for (int j = 0; j < 8; ++j) {
        hysteresis.stiffness[j] = 375.0;
        hysteresis.breakaway[j] = 375.0 * 5e-5 * std::pow(1.6, j);
    }
    auto& error = drive.gear.kinematic_error;
    error.order.count = error.amplitude.count = error.phase.count = 10;
    for (int n = 1; n <= 10; ++n) {
        error.order[n - 1] = double(n);
        error.amplitude[n - 1] = n == 2 ? 2e-4 : 2e-5 / n;
    }
    auto& friction = drive.gear.friction_input;
    friction.coulomb = 0.03;
    friction.breakaway = 0.045;
    friction.stribeck_speed = 2.0;
    friction.bristle_stiffness = 50.0;
    friction.bristle_damping = 0.02;
    friction.viscous = 5e-5;
    drive.gear.friction_output.viscous = 0.5;
    return drive.compile();
}

/// Operations of one of a second of steps, on average.
double operations_of_a_step() {
    constexpr int steps = 5000;
    constexpr double dt = 2e-4;
    const auto drive = reference_drive();
    const auto input = [](double t) {
        return Input<S>{0.3 * t + 0.2 * std::sin(4.0 * pi * t), 0.3 + 0.8 * pi * std::cos(4.0 * pi * t), 0.0, 293.15};
    };
    auto at = drive.standing(drive.rest(), input(0.0));
    counting::operations = 0;
    for (int i = 0; i < steps; ++i) {
        const double t = dt * i;
        const Interval<S> u{input(t), input(t + 0.5 * dt), input(t + dt)};
        at = drive.standing(integrate::exponential_step(drive, at, u, S(dt)), u.end);
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
