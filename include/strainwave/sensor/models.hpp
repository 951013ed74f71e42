#pragma once
#include <strainwave/list.hpp>
#include <strainwave/sensor/delayed.hpp>
#include <strainwave/sensor/encoder.hpp>
#include <strainwave/sensor/first_order.hpp>
#include <strainwave/sensor/gain.hpp>
#include <strainwave/sensor/ideal.hpp>
#include <strainwave/sensor/noisy.hpp>
#include <strainwave/sensor/quantised.hpp>
#include <strainwave/sensor/second_order.hpp>
#include <strainwave/sensor/sine_cosine_encoder.hpp>

/// The closed list of sensors: one more is its header, and here its include and its name. The first is the default.
namespace strainwave::sensor {

using Plain = List<Ideal, Gain, FirstOrder, SecondOrder, Encoder, SineCosineEncoder>;
using Late = Extended<Plain, Delayed>;
using Loud = Extended<Late, Noisy>;
using Models = Extended<Loud, Quantised>;

}  // namespace strainwave::sensor
