#pragma once
#include <strainwave/compiled.hpp>
#include <strainwave/condition.hpp>
#include <strainwave/stiffness/cubic.hpp>

namespace strainwave {

namespace stiffness {

template <class S, class Law_ = Cubic<S>>
struct TwoSided {
    using Law = Law_;

    Law law{};
    S negative_factor{1.0};

    static constexpr auto name = "two_sided";
    static constexpr auto source = SW_REVIEW
        ", section 3: the cubic polynomial \"cannot describe asymmetric behavior\"; one factor for the negative sense is assumed";
    static constexpr bool odd = false;
    static constexpr auto doc = R"(
        Spring that is stiffer in one sense of twist than in the other.

        .. math:: T = T_{law}(\delta) \; (\delta \ge 0), \qquad T = f\, T_{law}(\delta) \; (\delta < 0)

        with delta the twist, f = negative_factor, ``law`` any odd spring. Torque and energy are continuous at zero twist, where
        the stiffness jumps by f; there it is that of the positive sense. Knees stay at their twists. With f = 1 the law is the
        spring itself. Leaves out a difference of shape between the senses.

        A loop shows the asymmetry only together with its zeros of twist and torque. A spring that bends at a torque other than
        zero, as by a preload of the teeth, is not of this kind.

        >>> from strainwave.stiffness import TwoSided, Linear
        >>> spring = TwoSided(law=Linear(k=1e4), negative_factor=0.75)
        >>> spring.torque([0.001, -0.001]), spring.tangent(-0.001), spring.energy(-0.001)
        (array([10. , -7.5]), 7500.0, 0.00375))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, law, "The spring at positive twist"));
        visit(
            SW_REQUIRED(m, negative_factor, "1", "Torque at a negative twist f, relative to that at the opposite twist", smallest));
    }

    constexpr auto compile() const { return TwoSided<S, decltype(compiled(law))>{compiled(law), negative_factor}; }

    constexpr S torque(const S& twist) const { return factor(twist) * law.torque(twist); }
    constexpr S twist(const S& torque) const { return law.twist(torque / factor(torque)); }
    constexpr S tangent(const S& twist) const { return factor(twist) * law.tangent(twist); }
    constexpr S energy(const S& twist) const { return factor(twist) * law.energy(twist); }

    template <class Where>
    constexpr bool bounded() const {
        return strainwave::bounded<Where>(law);
    }
    /// Range in which its spring is valid.
    constexpr Domain<S> domain(const S& twist) const { return strainwave::domain<S>(law, twist); }

private:
    /// Factor in the sense of a twist or torque.
    constexpr S factor(const S& way) const { return select(way < S(0.0), negative_factor, S(1.0)); }
};

}  // namespace stiffness
}  // namespace strainwave
