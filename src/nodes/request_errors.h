#pragma once

namespace knee_robot::nodes {

/// roscpp lets only one kind of exception come out of the functions that serve its XML-RPC interface; any other ends the
/// process: a paramUpdate of a name that is none, for one, which needs no permission. In a program that calls this
/// they are answered as a fault of the request, and so is `system.multicall`, by which one request could end it, too.
void answerRequestErrors();

}  // namespace knee_robot::nodes
