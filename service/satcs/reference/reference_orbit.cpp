#include "service/satcs/reference/reference_orbit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace reident::satcs::reference {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double degree = pi / 180;
/// 2015-01-01T00:00:00Z: the spacecraft passes its ascending node.
constexpr storage::Time reference_instant = 1'420'070'400 * storage::second_ns;
constexpr double day_s = 86'400;
constexpr double year_s = 365.2422 * day_s;
/// From the reference instant to the following March equinox (2015-03-20T22:45Z).
constexpr double equinox_s = (78 * 24 + 22.75) * 3600;
/// From the reference instant to the following perihelion (2015-01-04T06:36Z).
constexpr double perihelion_s = (3 * 24 + 6.6) * 3600;

struct Station {
  double latitude_deg;
  double longitude_deg;
};
constexpr std::array<Station, 5> stations = {{{-15.55, -56.07},  // Cuiaba
                                              {-2.34, -44.40},   // Alcantara
                                              {40.45, 116.86},   // Miyun
                                              {23.15, 113.35},   // Guangzhou
                                              {43.80, 87.62}}};  // Urumqi

double since_reference_s(storage::Time time) {
  return static_cast<double>(time - reference_instant) * 1e-9;
}

}  // namespace

Orbit::Orbit(const OrbitConstants& constants)
    : constants_(constants),
      // The ascending node's local time is 12 h later, and so is the meridian's of the Sun.
      node_angle_(constants.local_time_descending_h * 15 * degree),
      sin_inclination_(std::sin(constants.inclination_deg * degree)),
      cos_inclination_(std::cos(constants.inclination_deg * degree)),
      horizon_dip_(std::acos(constants.earth_radius_km / constants.semi_major_axis_km)) {
  const double elevation = constants.min_elevation_deg * degree;
  const double ratio = constants.earth_radius_km / constants.semi_major_axis_km;
  contact_cos_ = std::cos(std::acos(ratio * std::cos(elevation)) - elevation);
}

Orbit::Sun Orbit::sun(storage::Time time) const {
  // Seen from the ascending node's direction: x to the node, z to the north pole.
  const double longitude = 2 * pi * (since_reference_s(time) - equinox_s) / year_s;
  const double sin_declination = std::sin(constants_.obliquity_deg * degree) * std::sin(longitude);
  const double cos_declination = std::sqrt(1 - sin_declination * sin_declination);
  const double x = cos_declination * std::cos(node_angle_);
  const double y = -cos_declination * std::sin(node_angle_);
  const double z = sin_declination;
  const double along = cos_inclination_ * y + sin_inclination_ * z;
  const double normal = -sin_inclination_ * y + cos_inclination_ * z;
  return {std::asin(std::clamp(normal, -1.0, 1.0)), std::atan2(along, x)};
}

Orbit::Count Orbit::count(storage::Time time) const {
  const double orbits = since_reference_s(time) / constants_.period_s;
  const double whole = std::floor(orbits);
  return {static_cast<std::int64_t>(whole), orbits - whole};
}

double Orbit::beta(storage::Time time) const {
  return sun(time).beta;
}

double Orbit::noon_phase(storage::Time time) const {
  const double phase = sun(time).argument / (2 * pi);
  return phase - std::floor(phase);
}

double Orbit::illumination(storage::Time time) const {
  const Sun sun_now = sun(time);
  const double argument = 2 * pi * count(time).phase;
  const double cos_zenith = std::cos(argument - sun_now.argument) * std::cos(sun_now.beta);
  const double elevation = pi / 2 + horizon_dip_ - std::acos(std::clamp(cos_zenith, -1.0, 1.0));
  const double radii = elevation / (constants_.sun_radius_deg * degree);
  if (radii >= 1) return 1;
  if (radii <= -1) return 0;
  return 1 - (std::acos(radii) - radii * std::sqrt(1 - radii * radii)) / pi;
}

double Orbit::relative_flux(storage::Time time) const {
  const double anomaly = 2 * pi * (since_reference_s(time) - perihelion_s) / year_s;
  const double distance_au = 1 - constants_.earth_eccentricity * std::cos(anomaly);
  return 1 / (distance_au * distance_au);
}

bool Orbit::in_contact(storage::Time time) const {
  const double u = 2 * pi * count(time).phase;
  const double latitude_sin = sin_inclination_ * std::sin(u);
  const double latitude_cos = std::sqrt(1 - latitude_sin * latitude_sin);
  // Local mean solar time less universal time is the longitude.
  const double from_sun = node_angle_ + std::atan2(cos_inclination_ * std::sin(u), std::cos(u));
  const double day = since_reference_s(time) / day_s;
  const double longitude = from_sun - (2 * pi * (day - std::floor(day)) - pi);
  return std::any_of(stations.begin(), stations.end(), [&](const Station& station) {
    const double cos_angle = latitude_sin * std::sin(station.latitude_deg * degree) +
                             latitude_cos * std::cos(station.latitude_deg * degree) *
                                 std::cos(longitude - station.longitude_deg * degree);
    return cos_angle > contact_cos_;
  });
}

}  // namespace reident::satcs::reference
