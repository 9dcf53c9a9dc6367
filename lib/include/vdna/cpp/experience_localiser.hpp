/** @file vdna/cpp/experience_localiser.hpp
 *  @brief The places of an experience, and a localiser in it that is set up by them.
 */
#ifndef VDNA_CPP_EXPERIENCE_LOCALISER_HPP
#define VDNA_CPP_EXPERIENCE_LOCALISER_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <vdna/cpp/localiser.hpp>
#include <vdna/geodesy.h>
#include <vdna/identity.h>
#include <vdna/map.h>

namespace vdna
{

/** Which frames of an experience show the same place: `place` and `tolerance` of a
 *  vdna_localise_config. */
struct Places {
    std::vector<int64_t> number; /**< [frames], VDNA_PLACE_NONE = a place of its own; empty = every
                                      frame's number is its index */
    uint32_t tolerance;          /**< greatest difference of two numbers of the same place */
};

/** Numbers the frames of a route so that a spot has the same number whenever it is passed. Some
 *  frames become posts, which mark the spots; they lie too far apart to be many in one spot, so the
 *  time is linear in the frames. */
class RoutePlaces
{
  public:
    using Position = std::array<double, 3>;

    /** @param tolerance  metres, above 0 */
    explicit RoutePlaces(double tolerance) : tolerance_(tolerance) {}

    /** The number of the next frame.
     *  @param position  finite
     *  @param index     its number if it is the first to pass; greater than those before */
    int64_t number(const Position &position, int64_t index)
    {
        leave_posts(position);
        if (const std::optional<int64_t> earlier = passed_before(position))
            return *earlier;
        const auto is_close = [&](const Post &post) {
            return apart(post.position, position) < tolerance_ / 4;
        };
        if (std::none_of(near_.begin(), near_.end(), is_close))
            near_.push_back({position, index});
        return index;
    }

    static double apart(const Position &a, const Position &b)
    {
        return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
    }

  private:
    using Cell = std::array<int64_t, 3>;

    struct Post {
        Position position;
        int64_t number;
    };

    struct CellHash {
        size_t operator()(const Cell &cell) const
        {
            uint64_t hash = 0;
            for (const int64_t side : cell)
                hash = (hash ^ static_cast<uint64_t>(side)) * 0x9e3779b97f4a7c15u;
            return static_cast<size_t>(hash ^ hash >> 32);
        }
    };

    // Cells are cubes of the tolerance's size.
    Cell cell_of(const Position &position) const
    {
        constexpr double farthest = 1e15; // the cells beyond are one
        Cell cell{};
        for (size_t i = 0; i < cell.size(); i++)
            cell[i] = static_cast<int64_t>(
                std::clamp(std::floor(position[i] / tolerance_), -farthest, farthest));
        return cell;
    }

    void leave_posts(const Position &position)
    {
        const auto is_near = [&](const Post &post) {
            return apart(post.position, position) <= 2 * tolerance_;
        };
        const auto left = std::stable_partition(near_.begin(), near_.end(), is_near);
        for (auto post = left; post != near_.end(); ++post)
            left_[cell_of(post->position)].push_back(*post);
        near_.erase(left, near_.end());
    }

    // The number of the nearest post within tolerance that was left.
    std::optional<int64_t> passed_before(const Position &position) const
    {
        std::optional<int64_t> number;
        double least = tolerance_;
        const auto look_at = [&](const Post &post) {
            const double d = apart(post.position, position);
            if (d < least || (d == least && post.number < number.value_or(post.number + 1))) {
                least = d;
                number = post.number;
            }
        };
        const Cell middle = cell_of(position);
        for (int64_t n = 0; n < 27; n++) {
            const auto posts = left_.find(
                {middle[0] + n % 3 - 1, middle[1] + n / 3 % 3 - 1, middle[2] + n / 9 - 1});
            if (posts != left_.end())
                std::for_each(posts->second.begin(), posts->second.end(), look_at);
        }
        return number;
    }

    double tolerance_;
    std::vector<Post> near_; // not left yet
    std::unordered_map<Cell, std::vector<Post>, CellHash> left_;
};

/** The horizontal positions of an experience's frames: height 0.
 *  @return [frames], of which those not known are not finite; empty without positions */
inline std::vector<RoutePlaces::Position> ground_positions_of(const vdna_experience &experience)
{
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    const bool is_global = std::string(experience.position_frame) == VDNA_FRAME_WGS84;
    std::vector<RoutePlaces::Position> ground(experience.frame_position ? experience.frames : 0);
    for (size_t i = 0; i < ground.size(); i++) {
        const double *const p = experience.frame_position + 3 * i;
        ground[i] = {p[0], p[1], 0};
        if (is_global && vdna_geodesy_to_ground(p, ground[i].data()) != VDNA_OK)
            ground[i].fill(unknown);
    }
    return ground;
}

/** The median distance of frames that follow one another, of an even number the upper one.
 *  @return metres; 0 if no two neighbours have a position */
inline double median_spacing_of(const std::vector<RoutePlaces::Position> &positions)
{
    std::vector<double> spacings;
    for (size_t i = 1; i < positions.size(); i++) {
        const double apart = RoutePlaces::apart(positions[i - 1], positions[i]);
        if (std::isfinite(apart)) // not if one is unknown
            spacings.push_back(apart);
    }
    if (spacings.empty())
        return 0;
    const auto middle = spacings.begin() + static_cast<std::ptrdiff_t>(spacings.size() / 2);
    std::nth_element(spacings.begin(), middle, spacings.end());
    return *middle;
}

/** Number the frames of a route as places_of() defines it.
 *  @param positions  [frames], not finite = not known
 *  @return [frames] */
inline std::vector<int64_t> route_numbers_of(const std::vector<RoutePlaces::Position> &positions,
                                             double tolerance)
{
    std::vector<int64_t> numbers;
    RoutePlaces route(tolerance);
    for (const RoutePlaces::Position &p : positions) {
        const bool is_known = std::isfinite(p[0] + p[1] + p[2]);
        const auto index = static_cast<int64_t>(numbers.size());
        numbers.push_back(is_known ? route.number(p, index) : VDNA_PLACE_NONE);
    }
    return numbers;
}

/** Choose the places of an experience, so that the filter gathers the frames that are good matches
 *  of one another.
 *
 *  Definition. T = `tolerance`; S = the median horizontal distance of frames that follow one
 *  another, those with an unknown position left out.
 *
 *  - With positions, that is if S > 0, the tolerance is T / S, rounded down, at most the frames. In
 *    the order of the drive, a frame without a position has VDNA_PLACE_NONE. A frame within T of
 *    posts that were left passes a spot again: it has the number of the nearest, the lowest of
 *    equals. Any other frame has its index, and becomes a post unless one of those not left yet is
 *    nearer than T / 4. A post is left by the first frame that is farther than 2 T from it: a robot
 *    that stands, creeps or turns passes nothing again.
 *  - Otherwise, with place numbers, these are the numbers, and the tolerance is T, rounded down.
 *  - Otherwise a frame's number is its index, and the tolerance 2.
 *
 *  If every number is the frame's index, `number` is empty: localising is cheaper then. It always
 * is with positions and T = 0.
 *  @param experience  its embeddings do not matter
 *  @param tolerance   within which a match is good, >= 0: metres with positions, else place numbers
 */
inline Places places_of(const vdna_experience &experience, double tolerance)
{
    const std::vector<RoutePlaces::Position> positions = ground_positions_of(experience);
    const double spacing = median_spacing_of(positions);
    const auto rounded_down = [](double number, uint32_t most) {
        return static_cast<uint32_t>(std::min(number, static_cast<double>(most)));
    };
    Places places{{}, 2};
    if (spacing > 0) {
        places.tolerance = rounded_down(tolerance / spacing, experience.frames);
        if (tolerance > 0)
            places.number = route_numbers_of(positions, tolerance);
    } else if (experience.frame_place) {
        places.tolerance = rounded_down(tolerance, std::numeric_limits<uint32_t>::max());
        places.number.assign(experience.frame_place, experience.frame_place + experience.frames);
    }
    int64_t index = 0;
    const auto is_index = [&](int64_t number) { return number == index++; };
    if (std::all_of(places.number.begin(), places.number.end(), is_index))
        places.number.clear();
    return places;
}

/** Follows a robot in an experience, by places that fit it. */
class ExperienceLocaliser
{
  public:
    /** Distances are about the means if the experience's embeddings are made for that. Throws
     * Error.
     *  @param experience  needed for this call only
     *  @param tolerance   as for places_of() */
    ExperienceLocaliser(const vdna_experience &experience, double tolerance)
        : ExperienceLocaliser(experience, tolerance,
                              vdna_identity_is_centred(&experience.identity) != 0)
    {
    }

    /** The same, with a choice of distances: about the means or not. */
    ExperienceLocaliser(const vdna_experience &experience, double tolerance, bool is_centred)
        : map_(experience.embeddings, experience.frames, experience.identity.dim, experience.name,
               is_centred),
          localiser_(map_, config_of(places_of(experience, tolerance), is_centred), experience.name)
    {
    }

    /** The C object, for every call that this class does not wrap. */
    vdna_localise *get() { return localiser_.get(); }
    const vdna_localise *get() const { return localiser_.get(); }

    /** Bytes that the frames and the localiser take. */
    size_t memory_size() const { return map_.memory_size() + localiser_.memory_size(); }

  private:
    // Borrows `places`.
    static vdna_localise_config config_of(const Places &places, bool is_centred)
    {
        // The defaults look at distances about the means; these do not look at distances.
        static constexpr double by_any_distance[] = {-2.5, 0.53, 1.1, 0};
        vdna_localise_config config;
        vdna_localise_config_init(&config);
        config.tolerance = places.tolerance;
        config.place = places.number.empty() ? nullptr : places.number.data();
        if (!is_centred)
            std::copy(std::begin(by_any_distance), std::end(by_any_distance), config.confidence);
        return config;
    }

    LocaliserMap map_;
    Localiser localiser_;
};

} // namespace vdna

#endif
