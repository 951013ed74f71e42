#pragma once
#include <strainwave/control/cascade.hpp>
#include <strainwave/control/feedback_linearisation.hpp>
#include <strainwave/control/kinematic_error_tracking.hpp>
#include <strainwave/control/lead_lag.hpp>
#include <strainwave/control/open_loop.hpp>
#include <strainwave/control/pi.hpp>
#include <strainwave/control/pid.hpp>
#include <strainwave/control/position_speed.hpp>
#include <strainwave/control/sampled.hpp>
#include <strainwave/control/state_feedback.hpp>
#include <strainwave/control/state_space.hpp>
#include <strainwave/list.hpp>

/// The closed list of controllers: one more is its header, and here its include and its name. The first is the default.
namespace strainwave::control {

using Continuous = List<OpenLoop, PID, PI, PositionSpeed, Cascade, LeadLag, StateFeedback, StateSpace, FeedbackLinearisation,
                        KinematicErrorTracking>;
using Models = Extended<Continuous, Sampled>;

}  // namespace strainwave::control
