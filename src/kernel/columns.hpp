#pragma once
#include "buffer.hpp"
#include "places.hpp"
#include "table.hpp"

namespace strainwave::kernel {

/// Rows of samples filled column by column. They lie far apart, so a stretch of columns is gathered before it is written:
/// write(row of the output, scalars, their count, index of the first).
template <class S, class Write>
class Columns {
    static constexpr std::size_t stretch = 16;
    const Rows& rows;
    const Places place;  ///< of each output of the drive
    const Write& write;
    Buffer<S> held;
    std::size_t written = 0, gathered = 0;

public:
    Columns(const Rows& rows_, const Places& place_, const Write& write_)
        : rows(rows_), place(place_), write(write_), held(rows_.count * stretch) {}

    template <int n>
    void operator()(const Array<S, n>& outputs) {
        for (std::size_t r = 0; r < rows.count; ++r) held[r * stretch + gathered] = outputs[place.slot[rows.recorded[r]]];
        if (++gathered == stretch) flush();
    }
    void flush() {
        for (std::size_t r = 0; r < rows.count; ++r) write(r, &held[r * stretch], gathered, written);
        written += gathered;
        gathered = 0;
    }
};

}  // namespace strainwave::kernel
