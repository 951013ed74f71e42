#pragma once
#include <strainwave/array.hpp>
#include <strainwave/math.hpp>

namespace strainwave {

/// Pseudo-random numbers of three small congruential generators (WichmannHill1982). No number in it exceeds 2^24, so that
/// every scalar, float included, draws the very same.
template <class S>
struct WichmannHill {
    static constexpr double highest_seed = 16777215.0;

    S x{1.0}, y{1.0}, z{1.0};

    /// Neighbouring seeds share nothing: each component is stirred into the next, modulo another prime.
    static constexpr WichmannHill seeded(const S& seed) {
        const S number = clip(rint(value_only(seed)), S(0.0), S(highest_seed));
        const S high = rint(number / S(4096.0)), low = number - S(4096.0) * high;
        WichmannHill drawn{low + S(2049.0), high + S(1.0), S(1.0)};
        for (int i = 0; i < 16; ++i) {
            drawn.x = positive(modulo(S(171.0) * drawn.x + drawn.y, 30269.0));
            drawn.y = positive(modulo(S(172.0) * drawn.y + drawn.z, 30307.0));
            drawn.z = positive(modulo(S(170.0) * drawn.z + drawn.x, 30323.0));
        }
        return drawn;
    }

    constexpr void advance() {
        x = modulo(S(171.0) * x, 30269.0);
        y = modulo(S(172.0) * y, 30307.0);
        z = modulo(S(170.0) * z, 30323.0);
    }

    /// The next number, within [-1/2, 1/2].
    constexpr S share() {
        advance();
        const S sum = x / S(30269.0) + y / S(30307.0) + z / S(30323.0);
        return sum - rint(sum);
    }

    /// The next whole number in [0, 256).
    constexpr S byte() {
        advance();
        return modulo(part(x, 30269.0) + part(y, 30307.0) + part(z, 30323.0), 256.0);
    }

private:
    /// Valid for whole numbers in [0, 2^24 - divisor].
    static constexpr S modulo(const S& number, double divisor) {
        const S rest = number - S(divisor) * rint(number / S(divisor));
        return select(rest < S(0.0), rest + S(divisor), rest);
    }
    /// Index of the 256th of [0, divisor) that contains the number.
    static constexpr S part(const S& number, double divisor) {
        const S scaled = S(256.0) * number;
        return (scaled - modulo(scaled, divisor)) / S(divisor);
    }
    /// A component that is 0 would stay 0.
    static constexpr S positive(const S& number) { return max(number, S(1.0)); }
};

/// Waves of a band that together are noise, drawn by a seed (ShinozukaDeodatis1991). The band has cells of equal width; each holds
/// one order, its place in the cell and its phase drawn. The sum of all cosines, times sqrt(2 / waves), has the root mean square 1.
template <class S>
struct Spectrum {
    static constexpr int waves = 32;
    static constexpr double weight = 0.25;  // sqrt(2 / waves)

    Array<S, waves> order{}, phase{};

    /// The sum of the cosines of its waves, after so many turns of order 1.
    constexpr S sum(const S& turns) const {
        Array<S, waves> cosine{};
        for (int k = 0; k < waves; ++k) {
            const S turned = order[k] * turns;
            cosine[k] = S(2.0 * pi) * (turned - rint(turned)) + phase[k];
        }
        to_cosines(cosine.item, waves);
        S total{0.0};
        for (int k = 0; k < waves; ++k) total = total + cosine[k];
        return total;
    }

    static constexpr Spectrum drawn(const S& lowest, const S& highest, const S& seed) {
        Spectrum spectrum{};
        const S cell = (highest - lowest) / S(waves);
        auto random = WichmannHill<S>::seeded(seed);
        for (int k = 0; k < waves; ++k) {
            // Places with few digits: if the ends of the band have few, every scalar rounds none of the orders.
            const S place = S(k) + (random.byte() + S(0.5)) / S(256.0);
            spectrum.order[k] = lowest + place * cell;
            spectrum.phase[k] = S(2.0 * pi) * random.share();
        }
        return spectrum;
    }
};

}  // namespace strainwave
