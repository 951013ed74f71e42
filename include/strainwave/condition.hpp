#pragma once

namespace strainwave {

/// A relation a set of parameters should obey: `left >= right`, in words and numbers.
template <class S>
struct Condition {
    const char* left_name;
    S left;
    const char* right_name;
    S right;
    const char* unit;
};

}  // namespace strainwave
