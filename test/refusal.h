#pragma once

#include <string>

#include "knee_robot/base/errors.h"

namespace knee_robot {

/// The message of the InputError that `action` throws; empty when it throws none.
template <typename Action>
std::string refusalOf(const Action& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace knee_robot
