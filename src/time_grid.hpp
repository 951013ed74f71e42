#pragma once
#include <cstddef>
#include <cstdint>

/// Instants of the steps of a run.
namespace strainwave::host {

/// A series of instants [s], in order.
struct Instants {
    const double* first;
    std::size_t count;
};

/// Counts of the instants and of the samples among them, and the longest step [s].
struct Merged {
    std::size_t count, samples;
    double longest;
};

/// Writes the instants of three series in order, those within `tolerance` [s] of each other as one, and 1 for each that is a
/// sample.
Merged merge(const Instants& steps, const Instants& samples, const Instants& breaks, double tolerance, double* instants,
             std::uint8_t* sampled);

/// Copies the first `count` samples among some instants.
void copy_samples(const double* instants, const std::uint8_t* sampled, std::size_t count, double* samples);

}  // namespace strainwave::host
