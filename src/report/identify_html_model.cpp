#include <cmath>

#include "friction_html.h"
#include "html_parts.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/report/identify_report.h"
#include "knee_robot/report/svg_plot.h"

namespace knee_robot::report {
namespace {

std::string parameterRow(const dynamics::ModelParameter& p, bool own) {
  return std::string(own ? "<tr>" : "<tr class=\"silent\">") + "<td>" + escapeHtml(p.name) + "</td><td>" +
         (own ? shortNumber(p.value, 4) : "&ndash;") + "</td><td>" + htmlNumber(p.std) + "</td><td>" +
         htmlNumber(own && p.value != 0.0 ? 100.0 * p.std / std::abs(p.value) : std::nan("")) +
         "</td><td class=\"text\">" + p.unit + "</td><td class=\"text\">" + verdictText(p.verdict) + "</td></tr>\n";
}

constexpr const char* kParameterHead =
    "<table><tr><th>parameter</th><th>value</th><th>standard error</th><th>%</th><th class=\"text\">unit</th><th "
    "class=\"text\">verdict</th></tr>\n";

std::string frictionTable(const identification::Identification& id) {
  std::string out =
      "<table><tr><th>per actuator</th><th class=\"text\">friction near rest</th><th>residual (training, moving), "
      "N</th></tr>\n";
  for (std::size_t i = 0; i < id.model.friction.size(); ++i) {
    out += "<tr><td>" + std::to_string(i + 1) + "</td><td class=\"text\">" + dynamics::nameOf(id.model.friction[i]) +
           ": " + escapeHtml(dynamics::describe(id.model.friction[i])) + "</td><td>" +
           shortNumber(id.model.residual_rms_N[i], 3) + "</td></tr>\n";
  }
  return out + "</table>\n";
}

std::string linkTable(const IdentifyResults& r) {
  std::string out =
      "<table><tr><th>link</th><th>mass, kg</th><th>prior, kg</th><th>centre of mass, mm</th><th>prior, "
      "mm</th><th>principal "
      "moments, g m<sup>2</sup></th><th>change from the prior, %</th></tr>\n";
  const auto millimetres = [](const mechanism::Vector3& c) {
    std::string text;
    for (const double value : c)
      text += (text.empty() ? "" : ", ") + shortNumber(std::round(1e4 * value) / 10 + 0.0);  // + 0.0: no "-0"
    return text;
  };
  for (const identification::PhysicalBody& one : r.physical->bodies) {
    const dynamics::LinkInertia &body = one.fitted, &prior = one.prior;
    const mechanism::Vector3 moments = dynamics::principalMoments(body);
    out += "<tr><td>" + escapeHtml(one.name) + "</td><td>" + shortNumber(body.mass, 3) + "</td><td>" +
           shortNumber(prior.mass, 3) + "</td><td>" + millimetres(body.center) + "</td><td>" +
           millimetres(prior.center) + "</td><td>" + shortNumber(1e3 * moments[0], 3) + ", " +
           shortNumber(1e3 * moments[1], 3) + ", " + shortNumber(1e3 * moments[2], 3) + "</td><td>" +
           shortNumber(100.0 * one.moved, 3) + "</td></tr>\n";
  }
  return out + "</table>\n";
}

}  // namespace

std::string verdictText(const std::string& verdict) {
  return verdict == "not identifiable" ? "not identifiable on this data" : verdict;
}

std::string identifyParameters(const identification::Identification& id) {
  std::string out = std::string("<h2>Parameters</h2>\n") + kParameterHead;
  std::string silent;
  int count = 0;
  for (const dynamics::ModelParameter& p : id.model.parameters) {
    const bool own = std::isfinite(p.std);
    (own ? out : silent) += parameterRow(p, own);
    count += !own;
  }
  out += "</table>\n<p class=\"key\">Standard errors: " + std::string("300 draws of a bootstrap over blocks of ") +
         htmlNumber(id.bootstrap_block_s) +
         " s, the length that the residual's autocorrelation asks for (Politis and White). Identified: standard error "
         "below 10 % of the value. Friction and rotor inertia are kept from becoming negative.</p>\n";
  out += "<details><summary>" + std::to_string(count) + " parameters that this data does not determine alone; " +
         std::to_string(id.model.base.size()) +
         " combinations of them are determined and are listed, with uncertainties, in model.yaml</summary>\n" +
         kParameterHead + silent + "</table></details>\n";
  return out + frictionTable(id) + frictionHtml(id.model.friction, id.friction);
}

std::string identifyPhysical(const IdentifyResults& r) {
  std::string out = "<h2>Physically consistent parameters</h2>\n";
  if (!r.physical) return out + "<p>Not fitted: " + escapeHtml(r.no_physical) + "</p>\n";
  const identification::PhysicalFit& fit = *r.physical;
  const std::size_t inertial = fit.bodies.size() * dynamics::kLinkParameters;
  PlotLine held{"held back", kModelColor, {}, {}};
  for (const identification::PhysicalPoint& p : fit.curve) {
    held.x.push_back(std::log10(p.strength));
    held.y.push_back(std::sqrt(p.held_back));
  }
  PlotStyle style;
  style.x_label = "log10 of the prior's strength";
  style.y_label = "rms / noise";
  style.log_y = true;
  style.markers = {std::log10(fit.strength)};
  out +=
      "<p>All " + std::to_string(inertial) + " inertial parameters of " + std::to_string(fit.bodies.size()) +
      " bodies that can exist, with friction, rotors and offsets, fitted to the same equations. The data decide " +
      htmlNumber(fit.supported) + " of " + std::to_string(inertial + static_cast<std::size_t>(r.after.model.axes)) +
      " directions (inertias and offsets); where they are silent the prior does: " + escapeHtml(r.urdf_path) +
      ". Strength of the prior (dashed): the strongest whose error on held-back blocks of the training data is within "
      "one standard error of the best. " +
      (fit.optimal ? "The solver ended at the optimum: no change of a body gains more than a millionth of the cost."
                   : "The solver stopped short of the optimum, at the boundary of what is possible: take these bodies "
                     "as possible ones, not as the best.") +
      "</p>\n";
  out += svgPlot({held}, style) + linkTable(r);
  return out +
         "<p class=\"key\">Written to identified.urdf and model_physical.yaml. Change from the prior: 0 % is the prior "
         "itself, 100 % a change as large as it, in its own metric.</p>\n";
}

}  // namespace knee_robot::report
