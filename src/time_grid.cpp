#include "time_grid.hpp"

#include <strainwave/field.hpp>

#include <algorithm>

namespace strainwave::host {

namespace {

/// A series of instants, and how far it has been gone through.
struct Queue {
    const double *next, *const end;
    double first;

    explicit Queue(const Instants& series) : next(series.first), end(next + series.count) { look(); }
    void look() { first = next < end ? *next : unbounded; }
    /// Go on from an instant, if it is the first.
    bool pass(double instant) {
        if (first != instant) return false;
        ++next;
        look();
        return true;
    }
};

}  // namespace

Merged merge(const Instants& steps, const Instants& samples, const Instants& breaks, double tolerance, double* instants,
             std::uint8_t* sampled) {
    Queue step(steps), sample(samples), jump(breaks);
    Merged merged{0, 0, 0.0};
    for (double before = -unbounded;;) {
        const double instant = std::min(std::min(step.first, sample.first), jump.first);
        if (instant == unbounded) break;
        if (instant - before > tolerance) {
            sampled[merged.count] = 0;
            instants[merged.count++] = instant;
        }
        before = instant;
        const std::size_t last = merged.count - 1;
        step.pass(instant);
        if (sample.pass(instant)) sampled[last] = 1;
        if (jump.pass(instant)) instants[last] = instant;  // a step that ends at a break does so exactly: the inputs jump
    }
    for (std::size_t i = 0; i < merged.count; ++i) {
        merged.samples += sampled[i];
        if (i > 0) merged.longest = std::max(merged.longest, instants[i] - instants[i - 1]);
    }
    return merged;
}

void copy_samples(const double* instants, const std::uint8_t* sampled, std::size_t count, double* samples) {
    for (std::size_t i = 0, k = 0; k < count; ++i) {
        samples[k] = instants[i];
        k += sampled[i];
    }
}

}  // namespace strainwave::host
