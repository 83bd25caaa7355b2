#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "feedforward_setup.h"
#include "knee_robot/control/answer.h"
#include "knee_robot/rt/property.h"

namespace knee_robot::control {

/// The components' properties while the controller runs: read, and changed within their range, the law's passivity, the
/// margin for a traced delay and, with a patient, near to what they were when he was loaded. Any thread.
class LiveProperties {
 public:
  /// Both must outlive this.
  LiveProperties(const rt::Deployment& deployment, const FeedforwardSetup& feedforward)
      : deployment_(deployment), feedforward_(feedforward), deployed_(all()) {}

  /// Of all components.
  std::vector<rt::PropertyReport> all() const;
  /// Gains and shares that are farther from what they were at the start than a patient's may be changed, in a sentence;
  /// empty: none.
  /// Payloads are the patient's own.
  std::string whyNotAsDeployed() const;
  /// From now on everything stays near to what it is now.
  void bind();
  /// Their range alone holds.
  void unbind();
  /// The patient has left: payloads, which were his, are what they were at the start.
  void forgetPayloads();
  /// The sentence says what was before.
  Answer set(const std::string& component, const std::string& property, const std::string& value);

 private:
  std::string whyTooFar(const std::string& component, const std::string& property, const std::string& value) const;

  const rt::Deployment& deployment_;
  const FeedforwardSetup& feedforward_;
  const std::vector<rt::PropertyReport> deployed_;
  std::mutex setting_;                     // one is judged with what the other has set
  mutable std::mutex mutex_;               // of what follows
  std::vector<rt::PropertyReport> bound_;  // empty: nobody is bound
};

/// How far a property may be changed from what it was: 20 % of it, payloads by 2 kg. A sentence, or empty. Of a
/// property that was no number there is no distance; a new value that is none is too far.
std::string whyTooFar(const rt::PropertyReport& was, const std::string& value);

}  // namespace knee_robot::control
