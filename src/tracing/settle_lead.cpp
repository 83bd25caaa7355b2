// Dead time or lag: to first order the same.

#include "settle_lead.h"

#include <algorithm>
#include <cmath>

#include "refit.h"
#include "selection.h"

namespace knee_robot::tracing {
namespace {

/// Factor by which the rival's held-back squares must be larger: friction whose law is not quite right makes less.
constexpr double kWorseBy = 1.1;
/// Least probability of the better one: what the two differ by is of second order, and smaller than most of what a model
/// may lack beside them.
constexpr double kSurely = 0.95;
constexpr double kAsProbable = 0.5;
/// Of the squares that are left while their axes move, least share that what leads saves there.
constexpr double kSavedInMotion = 0.4;

bool isOpen(const FoundEffect& e) {
  return e.hypothesis.place.candidate->leads() && !std::isnan(e.p);
}

/// The forces are late or early by it. Shows in the band that is searched, not only in a faster one.
bool isApartHere(const FoundEffect& e) {
  const Candidate& kind = *e.hypothesis.place.candidate;
  return (kind.leads() || kind.lags()) && !std::isnan(e.p) && e.band_hz == 0.0;
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

/// Share of the squares, held back and with samples near rest counting little, that leads and lags save on their
/// actuators.
double savedInMotion(Search& s) {
  const Attention own = s.attention;
  s.attention = Attention::Moving;
  setAttention(*s.data, s.attention);
  std::vector<Hypothesis> all = hypothesesOf(s.effects), others;
  int actuators = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (isApartHere(s.effects[k])) {
      actuators += all[k].place.actuator < 0 ? s.data->stack.axes : 1;
    } else {
      others.push_back(all[k]);
    }
  }
  const double with = problemOf(s, all).heldBack().sum(), without = problemOf(s, others).heldBack().sum();
  s.attention = own;
  setAttention(*s.data, own);
  return (without - with) / std::max(1e-300, with * actuators / s.data->stack.axes);
}

}  // namespace

void dropLeadsOfRest(Search& s) {
  if (std::none_of(s.effects.begin(), s.effects.end(), isApartHere) || savedInMotion(s) >= kSavedInMotion) return;
  for (const FoundEffect& e : s.effects) {
    if (isApartHere(e))
      s.taken_out.push_back(placeText(e.hypothesis.place) +
                            ": helps near rest only, where the force that builds up before an axis breaks away looks "
                            "the same; what is late is so in motion, too");
  }
  s.effects.erase(std::remove_if(s.effects.begin(), s.effects.end(), isApartHere), s.effects.end());
  refit(s);
}

void settleLeads(Search& s) {
  const std::vector<const Candidate*> kinds = leadingKinds(*s.library);
  if (kinds.size() != 2 || std::none_of(s.effects.begin(), s.effects.end(), isOpen)) return;
  const std::vector<FoundEffect> before = s.effects;
  const Eigen::VectorXd noise_N = s.rms_N;
  const auto rename = [&](const Candidate* kind) {
    for (FoundEffect& e : s.effects) {
      if (isOpen(e)) e.hypothesis.place.candidate = kind;
    }
    refit(s);
  };
  const auto become = [&](const Candidate* kind) {
    s.effects = before;
    rename(kind);
    rebase(s);  // beside the law near rest that suits it: the other one's would take its side
  };
  const auto heldBack = [&] {
    s.rms_N = noise_N;  // all weighted alike
    return problemOf(s, hypothesesOf(s.effects)).heldBack();
  };
  std::vector<Eigen::VectorXd> held_back;
  for (const Candidate* kind : kinds) {
    become(kind);
    held_back.push_back(heldBack());
  }
  const double first = probabilityPositive(held_back[1] - held_back[0]);
  const std::size_t best = first >= 0.5 ? 0 : 1;
  become(kinds[best]);
  const std::vector<FoundEffect> settled = s.effects;
  rename(kinds[1 - best]);  // beside the winner's law: or else two laws near rest were compared, not a delay and a lag
  const double least = kWorseBy * held_back[best].sum();
  const bool clearly = held_back[1 - best].sum() > least && heldBack().sum() > least;
  s.effects = settled;
  refit(s);
  const double probability = std::max(first, 1.0 - first);
  const double sure = clearly && probability > kSurely ? probability : kAsProbable;
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
