#pragma once

#include "search.h"

namespace knee_robot::tracing {

/// Takes out, the least needed first, effects without which held-back blocks are predicted as well; those of a given
/// model included.
void eliminateBackward(Search& search);

/// Takes out periodic effects that do not go on at positions which were held back, with all samples and while axes
/// move: remainders of a few stops look like a ripple of a short period, too.
void dropWhatDoesNotRepeat(Search& search);

/// Takes out what is something else with the shape that was refined beside others, or with the size that fits in the
/// end. Not those of a given model.
void dropImplausible(Search& search);

/// Takes out effects of one coefficient whose size is within three standard errors of none beside the others, the worst
/// first: what the baseline can do as well bends its parameters, and they are wrong on other movements. Not those of a
/// given model, nor of the fast band, whose size the slow rows hardly show.
void dropUnsized(Search& search);

/// A new effect that acts on all actuators may be what several others stood for together: those are taken out at once
/// where held-back blocks are predicted as well without them, its shape refined alone, within a standard error.
void standAlone(Search& search, const Place& place);

/// Puts the special case in place of an effect that generalizes it (a spring for a curve over the distance), where
/// held-back blocks are predicted no worse by it: while shapes are rough, what bends more fits better.
void simplify(Search& search);

/// Puts an effect that was found on another actuator in place of a map, where held-back blocks are predicted as well by
/// it, within a standard error: screws of one machine are alike.
void replaceMaps(Search& search);

}  // namespace knee_robot::tracing
