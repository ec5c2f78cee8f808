#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "softpoint/core/error.h"

namespace softpoint {

// The message of the Error that `action` throws; a failure of the test, and "", if it throws none.
template <class Action>
std::string refusal(Action&& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  ADD_FAILURE() << "nothing was refused";
  return "";
}

// `action` is refused with a message that holds every fragment.
template <class Action>
void expect_refusal(Action&& action, const std::vector<std::string>& fragments) {
  const std::string message = refusal(action);
  for (const std::string& fragment : fragments) {
    EXPECT_NE(message.find(fragment), std::string::npos) << "message: " << message << "\nlacks: " << fragment;
  }
}

}  // namespace softpoint
