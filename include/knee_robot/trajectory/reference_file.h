#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace knee_robot::trajectory {

/// What the four columns of a reference file mean.
enum class Space {
  Actuator,  ///< lengths q13, q23, q33, q42 (m); on a bench: the axes' positions (m)
  Platform,  ///< Xm, Zm (m), theta, psi (rad)
  Relative,  ///< lengths from home (m): the robot file's home_length_m is added
};

/// "actuator", "platform" or "relative"; empty for any other word.
std::optional<Space> spaceNamed(const std::string& name);
const char* nameOf(Space space);

/// One point a row: N x 4, row-major, so that a row is what `Sync` streams at once.
using Points = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;

/// Period at which `Sync` streams points; the only one that a playable reference may have.
inline constexpr double kStreamPeriod = 0.01;

/// Content of a reference file. Always whole: the reader returns all of a file or throws.
struct Reference {
  std::string name;               ///< of the file, for messages
  Space space = Space::Actuator;  ///< declared by the header or the caller, else actuator
  double period_s = kStreamPeriod;
  Points points;                   ///< N x 4, N >= 1, all finite
  int first_line = 1;              ///< line of the first point; point k stands on line first_line + k
  std::vector<std::string> notes;  ///< remarks of the file that look like a mistyped header

  int lineOf(Eigen::Index point) const { return first_line + static_cast<int>(point); }
};

/// Bounds of what the reader takes: three hours and more of motion.
inline constexpr std::size_t kMaxReferenceBytes = 64u << 20;
inline constexpr Eigen::Index kMaxReferencePoints = 1'000'000;

/// Reads a reference file strictly (docs/contract.md, section 2). Accepted: a byte order mark, CRLF, tabs, blanks
/// before and after numbers, a missing last newline, empty lines after the last point, `#` lines before the first point. Everything else
/// is an InputError naming FILE:LINE and what is wrong: another number of columns than four, a word, inf, nan, a
/// comment or an empty line between points, an unknown space or period, no point at all, more than the bounds above.
/// `space` is the caller's own declaration (a command line's --space); one that contradicts the header is an
/// InputError.
Reference readReference(const std::string& path, std::optional<Space> space = std::nullopt);

/// The same from memory; `name` stands for the file in messages.
Reference parseReference(const std::string& text, const std::string& name, std::optional<Space> space = std::nullopt);

/// The file's text: header with `comments`, space and period, then the points with nine decimals (1 nm: rounding then
/// adds 2e-5 m/s^2 to a second difference over 10 ms).
std::string formatReference(const Reference& reference, const std::vector<std::string>& comments = {});

/// formatReference written atomically.
void writeReference(const std::string& path, const Reference& reference, const std::vector<std::string>& comments = {});

}  // namespace knee_robot::trajectory
