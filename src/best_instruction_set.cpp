#include <cstdio>

#include "supported.hpp"

/// Run while the build is configured: writes the best instruction set of this machine.
int main() {
    for (const auto name : strainwave::host::instruction_sets)
        if (strainwave::host::supported(name)) return std::printf("%s", name.data()) > 0 ? 0 : 1;
    return 1;
}
