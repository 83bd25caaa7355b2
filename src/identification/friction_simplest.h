#pragma once

#include <cstddef>

namespace knee_robot::identification {

/// By which one family's held-back error is larger than another's, and how sure that is.
struct Worse {
  double mean = 0.0, standard_error = 0.0;
};

/// Whether `family` (friction_families.h) is near enough to the best one to be taken in its place, if it is the simplest
/// that is. `elements_of_best`: of the best family's law; `worse`: than the best; `times`: its held-back error over the
/// best's.
bool inPlaceOf(long best, std::size_t elements_of_best, long family, const Worse& worse, double times);

}  // namespace knee_robot::identification
