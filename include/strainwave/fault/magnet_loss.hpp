#pragma once
#include <strainwave/fault/fault.hpp>

namespace strainwave::fault {

template <class S>
struct MagnetLoss {
    S severity{1.0};
    S loss{0.3};

    static constexpr auto name = "magnet_loss";
    static constexpr auto mode = "Demagnetisation of the rotor";
    static constexpr auto effect = "less torque per current and less back-EMF per speed";
    static constexpr auto signal = "mean motor current at the same load; ratio of voltage to speed without load";
    static constexpr auto source = "definition; the loss at severity 1 is assumed";
    static constexpr auto doc = R"(
        Loss of flux, the same share of each magnet.

        .. math:: K_m \leftarrow (1 - s\, l)\, K_m, \qquad K_b \leftarrow (1 - s\, l)\, K_b, \qquad
                  \psi \leftarrow (1 - s\, l)\, \psi

        with s = severity, l = loss, K_m = torque_constant, K_b = back_emf, psi = flux_linkage of the motor, as far as it has
        them. The gains of its controller stay. Leaves out that one magnet may lose more than another.

        >>> from strainwave.fault import Facts, MagnetLoss
        >>> [change[1:4] for change in MagnetLoss(severity=0.5, loss=0.5).changes(Facts())][0]
        ('torque_constant', 'scale', 0.75))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, severity, "1", "Share s of the loss", 0, 1));
        visit(SW_FIELD(m, loss, "1", "Share l of the flux that is lost at severity 1", 0, 1));
    }

    template <class Visit>
    constexpr void changes(const Facts<S>&, Visit&& visit) const {
        constexpr Array<const char*, 3> quantities{{"torque_constant", "back_emf", "flux_linkage"}};
        for (const char* quantity : quantities.item) visit(scale(motor_place, quantity, S(1.0) - severity * loss));
    }
};

}  // namespace strainwave::fault
