#pragma once
#include "../kernel/assemble.hpp"
#include "drive.hpp"

namespace strainwave::general {

/// Calls f with the drive, or gear, that has the laws that a set chooses.
template <template <class> class Model, class S, class F>
auto with_model(const kernel::Set& set, const S* numbers, const F& f) {
    OwnedLaws laws;
    kernel::Reader<S> from{set.laws, set.shape, numbers, &laws};
    const auto model = kernel::assembled<Model<S>>(from);
    return f(model);
}

struct Drives {
    template <class S, class F>
    static auto with(const kernel::Set& set, const S* numbers, const F& f) {
        return with_model<GeneralDrive>(set, numbers, f);
    }
};

}  // namespace strainwave::general
