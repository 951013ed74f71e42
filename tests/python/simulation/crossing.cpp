#include <cmath>
#include <cstdio>
#include <strainwave/integrate/event_driven.hpp>
#include <strainwave/scalar/pack.hpp>

using namespace strainwave;

struct Margin {
    const char* name;
    double (*at)(double);
};

constexpr Margin margins[] = {
    {"straight", [](double t) { return 0.3 - t; }},
    {"parabola", [](double t) { return 0.09 - t * t; }},
    {"cubic", [](double t) { return 0.027 - t * t * t; }},
    {"exponential", [](double t) { return 1.0 - std::exp(8.0 * (t - 0.3)); }},
    {"rises_first", [](double t) { return t * (0.3 - t); }},
    {"plateau", [](double t) { return std::fmin(1e-12, 0.3 - t); }},
    {"small_start", [](double t) { return std::fmin(1e-12 + t, 2.0 * (0.3 - t)); }},
    {"jump", [](double t) { return t < 0.3 ? 2.0 : -1.0; }},
    {"jump_down", [](double t) { return t < 0.3 ? 1e-9 : -1e9; }},
};
constexpr int lanes = 16, count = sizeof margins / sizeof *margins;

/// Each of them in a lane of its own; the lanes that are left cross nowhere.
Pack<lanes> side_by_side(const Pack<lanes>& moments) {
    Pack<lanes> found(1.0);
    for (int i = 0; i < count; ++i) found.set(i, margins[i].at(moments[i]));
    return found;
}

/// Prints of each margin where it is found to cross zero, alone, and how often it was looked at; where as a lane among
/// others; and both in single precision.
int main() {
    const auto together = integrate::crossing<Pack<lanes>>(side_by_side, Pack<lanes>(0.0), side_by_side(0.0), side_by_side(1.0));
    for (int lane = 0; lane < count; ++lane) {
        const auto& [name, margin] = margins[lane];
        int looks = 0;
        const auto counted = [&](const double& moment) {
            ++looks;
            return margin(moment);
        };
        const double alone = integrate::crossing<double>(counted, 0.0, margin(0.0), margin(1.0));
        int single_looks = 0;
        const auto counted_single = [&](const float& moment) {
            ++single_looks;
            return float(margin(double(moment)));
        };
        const float single = integrate::crossing<float>(counted_single, 0.0f, float(margin(0.0)), float(margin(1.0)));
        std::printf("%s %.17g %d %.17g %.9g %d\n", name, alone, looks, together[lane], double(single), single_looks);
    }
    std::printf("nowhere 1 0 %.17g 1 0\n", together[count]);
}
