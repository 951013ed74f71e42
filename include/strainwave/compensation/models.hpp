#pragma once
#include <strainwave/compensation/adaptive_fourier.hpp>
#include <strainwave/compensation/bristle_observer.hpp>
#include <strainwave/compensation/disturbance_observer.hpp>
#include <strainwave/compensation/dither.hpp>
#include <strainwave/compensation/friction_scale.hpp>
#include <strainwave/compensation/iterative_learning.hpp>
#include <strainwave/compensation/lost_motion_map.hpp>
#include <strainwave/compensation/model_feedforward.hpp>
#include <strainwave/compensation/none.hpp>
#include <strainwave/compensation/repetitive.hpp>
#include <strainwave/compensation/twist_identification.hpp>
#include <strainwave/list.hpp>

/// The closed lists of compensators: one more is its header, and here its include and its name. The first is the default.
namespace strainwave::compensation {

using Feedforwards = List<NoFeedforward, ModelFeedforward, LostMotionMap>;
using Observers = List<NoObserver, DisturbanceObserver, FrictionScale, BristleObserver>;
using Dithers = List<NoDither, Dither>;
using Learners = List<NoLearning, AdaptiveFourier, Repetitive, IterativeLearning, TwistIdentification>;

}  // namespace strainwave::compensation
