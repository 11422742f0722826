#pragma once

#include <string>

namespace taut {

/// Digest of everything in this program that makes numbers: measurement() and every solver. What
/// one build found says nothing about another one.
std::string program_digest();

}  // namespace taut
