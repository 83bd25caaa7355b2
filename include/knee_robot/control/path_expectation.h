#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace knee_robot::control {

/// What still has to be so when a path begins, for whoever was asked for it some time ago.
struct PathExpectation {
  std::string reference = {};  ///< the loaded reference's name; empty: whichever is loaded
  /// ControlSystem::halts() of then: nobody has stopped the robot since; empty: of now.
  std::optional<std::uint64_t> halts = std::nullopt;
  /// WishesSoFar::pauses of then, likewise.
  std::optional<std::uint64_t> pauses = std::nullopt;
  /// PlayableReference::number() of what is loaded, which a name is not: a file changes. Empty: whichever is loaded.
  std::optional<std::uint64_t> loaded = std::nullopt;
};

}  // namespace knee_robot::control
