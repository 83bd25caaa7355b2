// Dead time or lag: to first order the same.

#include <algorithm>
#include <cmath>

#include "search.h"
#include "selection.h"

namespace knee_robot::tracing {
namespace {

/// Factor by which the rival's held-back squares must be larger: friction whose law is not quite right makes less.
constexpr double kWorseBy = 1.1;
constexpr double kAsProbable = 0.5;

bool isOpen(const FoundEffect& e) {
  return e.hypothesis.place.candidate->leads() && !std::isnan(e.p);
}

/// Candidates that lead, each once.
std::vector<const Candidate*> leadingKinds(const Library& library) {
  std::vector<const Candidate*> kinds;
  for (const PlaceColumns& p : library.places()) {
    const Candidate* kind = p.place().candidate;
    if (kind->leads() && std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) kinds.push_back(kind);
  }
  return kinds;
}

}  // namespace

void settleLeads(Search& s) {
  const std::vector<const Candidate*> kinds = leadingKinds(*s.library);
  if (kinds.size() != 2 || std::none_of(s.effects.begin(), s.effects.end(), isOpen)) return;
  const std::vector<FoundEffect> before = s.effects;
  const Eigen::VectorXd noise_N = s.rms_N;
  const auto become = [&](const Candidate* kind) {
    s.effects = before;
    for (FoundEffect& e : s.effects) {
      if (isOpen(e)) e.hypothesis.place.candidate = kind;
    }
    refit(s);
  };
  std::vector<Eigen::VectorXd> held_back;
  for (const Candidate* kind : kinds) {
    become(kind);
    s.rms_N = noise_N;  // both weighted alike
    held_back.push_back(fitOf(s, hypothesesOf(s.effects)).held_back);
  }
  const double first = probabilityPositive(held_back[1] - held_back[0]);
  const std::size_t best = first >= 0.5 ? 0 : 1;
  const bool clearly = held_back[1 - best].sum() > kWorseBy * held_back[best].sum();
  const double sure = clearly ? std::max(first, 1.0 - first) : kAsProbable;
  become(kinds[best]);
  for (FoundEffect& e : s.effects) {
    if (!isOpen(e)) continue;
    std::vector<std::string>& rivals = e.indistinguishable_from;
    const auto isLead = [&](const std::string& name) { return name == kinds[0]->name() || name == kinds[1]->name(); };
    if (std::any_of(rivals.begin(), rivals.end(), isLead)) e.probability = 1.0;  // of the two alone, until now
    rivals.erase(std::remove_if(rivals.begin(), rivals.end(), isLead), rivals.end());
    e.probability = std::min(e.probability, sure);
    if (sure < kSureOfName) rivals.push_back(kinds[1 - best]->name());
  }
}

}  // namespace knee_robot::tracing
