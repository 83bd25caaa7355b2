#pragma once

#include "knee_robot/tracing/hypothesis.h"

namespace knee_robot::tracing {

/// The columns of everything that may be added. Building and filtering them is most of the work of a search, and only
/// few of them change with the fit: they are kept from pass to pass.
class Library {
 public:
  /// `fast_only`: of those that show in fast motion.
  void add(const CandidateList& candidates, const TraceData& data, bool fast_only = false);
  /// After a fit: builds anew what looks at it; everything when the law of friction has changed as well.
  void update(const TraceData& data, bool friction_changed);
  const std::vector<PlaceColumns>& places() const { return places_; }

 private:
  std::vector<PlaceColumns> places_;
};

}  // namespace knee_robot::tracing
