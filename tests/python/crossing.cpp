#include <cmath>
#include <cstdio>
#include <strainwave/integrate/event_driven.hpp>
#include <strainwave/scalar/pack.hpp>

using namespace strainwave;

/// Prints where a margin is found to cross zero, and how often it was looked at.
template <class Margin>
void sought(const char* name, const Margin& margin) {
    int looks = 0;
    const auto counted = [&](const double& moment) {
        ++looks;
        return margin(moment);
    };
    const double found = integrate::crossing<double>(counted, 0.0, margin(0.0), margin(1.0));
    std::printf("%s %.17g %d\n", name, found, looks);
}

int main() {
    sought("straight", [](double t) { return 0.3 - t; });
    sought("parabola", [](double t) { return 0.09 - t * t; });
    sought("cubic", [](double t) { return 0.027 - t * t * t; });
    sought("exponential", [](double t) { return 1.0 - std::exp(8.0 * (t - 0.3)); });
    sought("rises_first", [](double t) { return t * (0.3 - t); });
    sought("plateau", [](double t) { return std::fmin(1e-12, 0.3 - t); });
    sought("small_start", [](double t) { return std::fmin(1e-12 + t, 2.0 * (0.3 - t)); });
    sought("jump", [](double t) { return t < 0.3 ? 2.0 : -1.0; });
    sought("jump_down", [](double t) { return t < 0.3 ? 1e-9 : -1e9; });
}
