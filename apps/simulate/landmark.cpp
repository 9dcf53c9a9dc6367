#include "simulate/landmark.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "simulate/chance.hpp"

namespace vdna::simulate
{

namespace
{

const Colour white = {255, 252, 250}, bark = rgb(0x5b4a3a), metal = rgb(0x5c6166);

template <size_t count>
Colour choose(const std::array<uint32_t, count> &palette, float hue)
{
    return rgb(palette[std::min(count - 1, static_cast<size_t>(hue * count))]);
}

// A side facing away from the sun is darker. The sun is on the left.
float shade(const Condition &condition, bool towards_sun)
{
    return 1 + condition.sun * (towards_sun ? .06f : -.34f);
}

Colour snowed(const Condition &condition, const Colour &colour, float share = 1)
{
    return mix(colour, white, condition.snow * share);
}

// Plants ------------------------------------------------------------------------------------

Colour leaf_colour(const Condition &condition, float hue)
{
    static constexpr std::array<uint32_t, 6> turned = {0xd9a520, 0xc8641c, 0xa83a20,
                                                       0xe0bb38, 0x8d8a2e, 0xc9801f};
    const Colour own = condition.leaves * (.85f + .3f * hue);
    return mix(own, choose(turned, hue), condition.turned);
}

bool flowers(const Condition &condition, const Landmark &plant)
{
    return static_cast<float>(plant.shape % 100) < 100 * condition.blossom;
}

// A round mass of leaves: discs across an ellipse, lighter towards the sun and the sky.
void paint_leaves(Stand &stand, cv::Point2f centre, cv::Point2f radii, const Colour &colour,
                  float share, const Landmark &plant)
{
    const Condition &condition = stand.condition();
    const bool flowering = flowers(condition, plant);
    static constexpr std::array<uint32_t, 3> petals = {0xf4d8e4, 0xf6f2ee, 0xe9a8c4};
    const Colour petal = choose(petals, plant.hue);

    Chance chance(plant.shape ^ 1);
    const int count = std::clamp(cvRound(stand.pixels(radii.y) * 9), 24, 700);
    const float size = 1.5f * std::sqrt(radii.x * radii.y / static_cast<float>(count));
    for (int i = 0; i < count; i++) {
        const float angle = chance.between(0, 2 * static_cast<float>(CV_PI));
        const float out = std::sqrt(chance.unit());
        const cv::Point2f at(out * std::cos(angle), out * std::sin(angle));
        const float radius = size * chance.between(.6f, 1.25f);
        const float speckle = chance.between(-.2f, .2f);
        const bool fallen = chance.unit() >= share, petalled = chance.happens(.45f);
        if (fallen)
            continue;
        const float lit = .82f + .2f * at.y + condition.sun * (.16f * at.y - .2f * at.x) + speckle;
        Colour tone = flowering && petalled ? petal : colour;
        tone *= std::max(.25f, lit);
        stand.disc(centre + cv::Point2f(at.x * radii.x, at.y * radii.y), radius,
                   snowed(condition, tone, at.y > .1f ? .85f : .25f));
    }
}

// One limb and its branches. Snow lies on limbs that are not too steep.
void paint_branch(Stand &stand, cv::Point2f from, float angle, float length, int forks,
                  Chance &chance)
{
    const cv::Point2f to = from + length * cv::Point2f(std::sin(angle), std::cos(angle));
    const float width = length * .09f;
    stand.line(from, to, width, bark);
    if (stand.condition().snow > 0 && std::abs(std::sin(angle)) > .3f)
        stand.line(from + cv::Point2f(0, width * .5f), to + cv::Point2f(0, width * .5f),
                   width * .6f, snowed(stand.condition(), bark));
    if (forks == 0 || stand.pixels(length) < 2)
        return;
    const int twigs = 2 + static_cast<int>(chance.below(2));
    for (int i = 0; i < twigs; i++)
        paint_branch(stand, from + (to - from) * chance.between(.65f, 1),
                     angle + chance.between(-.85f, .85f), length * chance.between(.55f, .78f),
                     forks - 1, chance);
}

void paint_tree(const Landmark &tree, Stand &stand)
{
    Chance chance(tree.shape);
    const float height = tree.height, trunk = height * chance.between(.03f, .05f);
    const cv::Point2f crown(height * chance.between(-.05f, .05f), height * .64f);
    const cv::Point2f radii(height * chance.between(.22f, .36f), height * .36f);
    stand.polygon(
        {{-trunk, 0}, {trunk, 0}, {trunk * .6f, height * .4f}, {-trunk * .6f, height * .4f}}, bark);
    if (stand.condition().foliage < .9f)
        for (float lean : {-.55f, -.15f, .2f, .6f})
            paint_branch(stand, {0, height * .36f}, lean + chance.between(-.15f, .15f),
                         height * chance.between(.24f, .32f), 4, chance);
    paint_leaves(stand, crown, radii, leaf_colour(stand.condition(), tree.hue),
                 stand.condition().foliage, tree);
}

void paint_conifer(const Landmark &conifer, Stand &stand)
{
    static const Colour needles = rgb(0x2f5a3a);
    const Condition &condition = stand.condition();
    Chance chance(conifer.shape);
    const float height = conifer.height;
    const int tiers = 5 + static_cast<int>(chance.below(4));
    const float spread = height * chance.between(.16f, .26f);
    stand.rectangle({-height * .02f, 0}, {height * .02f, height * .2f}, bark);
    for (int tier = 0; tier < tiers; tier++) {
        const float share = static_cast<float>(tier) / static_cast<float>(tiers);
        const float low = height * (.1f + .86f * share), half = spread * (1.05f - share);
        const float high = std::min(height, low + 1.9f * height / static_cast<float>(tiers));
        const Colour tone = needles * (.8f + .3f * conifer.hue + chance.between(-.1f, .1f));
        const float droop = half * .2f;
        stand.polygon({{-half, low - droop}, {0, low}, {0, high}}, tone * shade(condition, true));
        stand.polygon({{half, low - droop}, {0, low}, {0, high}}, tone * shade(condition, false));
        const Colour cap = snowed(condition, tone);
        if (condition.snow > 0)
            stand.polygon({{-half, low - droop},
                           {half, low - droop},
                           {half * .2f, low + half * .8f},
                           {-half * .2f, low + half * .8f}},
                          cap);
    }
}

void paint_bush(const Landmark &bush, Stand &stand)
{
    const float height = bush.height;
    const float share = std::max(stand.condition().foliage, .8f); // twigs hide the background
    paint_leaves(stand, {0, height * .45f}, {height * (.55f + .4f * bush.hue), height * .5f},
                 leaf_colour(stand.condition(), bush.hue), share, bush);
}

// Small things ------------------------------------------------------------------------------

void paint_rock(const Landmark &rock, Stand &stand)
{
    Chance chance(rock.shape);
    const Condition &condition = stand.condition();
    const float height = rock.height, half = height * chance.between(.6f, 1.1f);
    const Colour stone = rgb(0x8b8780) * (.7f + .5f * rock.hue);
    const float left = chance.between(.3f, .6f), right = chance.between(.2f, .5f);
    stand.polygon({{-half, 0},
                   {half, 0},
                   {half * .9f, height * right},
                   {half * .3f, height},
                   {-half * .4f, height * .95f},
                   {-half * .9f, height * left}},
                  stone * shade(condition, true));
    stand.polygon({{half * .1f, 0}, {half, 0}, {half * .9f, height * right}, {half * .3f, height}},
                  stone * shade(condition, false));
    if (condition.snow > 0)
        stand.polygon({{-half * .9f, height * left},
                       {half * .9f, height * right},
                       {half * .3f, height * 1.05f},
                       {-half * .4f, height}},
                      snowed(condition, stone));
}

void paint_sign(const Landmark &sign, Stand &stand)
{
    static constexpr std::array<uint32_t, 6> plates = {0x1d4fa0, 0xc02020, 0xe8c020,
                                                       0xf0f0ec, 0x1e7a3c, 0x7a4a20};
    static constexpr std::array<uint32_t, 3> marks = {0xf4f4f4, 0x202020, 0xd83030};
    const Condition &condition = stand.condition();
    Chance chance(sign.shape);
    const float top = sign.height, half = chance.between(.3f, .6f), tall = chance.between(.5f, .9f);
    const Colour plate = choose(plates, sign.hue), mark = choose(marks, chance.unit());
    stand.rectangle({-.04f, 0}, {.04f, top}, metal);
    if (chance.happens(.3f)) {
        stand.disc({0, top - .35f}, .42f, mark);
        stand.disc({0, top - .35f}, .33f, plate);
    } else {
        stand.rectangle({-half, top - tall}, {half, top}, mark);
        stand.rectangle({-half + .06f, top - tall + .06f}, {half - .06f, top - .06f}, plate);
    }
    for (uint32_t i = chance.below(3); i < 3; i++) {
        const float row = top - tall * (.25f + .25f * static_cast<float>(i));
        stand.rectangle({-half * .6f, row - .05f}, {half * chance.between(-.2f, .6f), row + .03f},
                        mark);
    }
    if (condition.snow > 0)
        stand.rectangle({-half, top}, {half, top + .08f}, white);
}

void paint_lamp(const Landmark &lamp, Stand &stand)
{
    const float head = lamp_head(lamp);
    stand.rectangle({-.07f, 0}, {.07f, .5f}, metal * .8f);
    stand.rectangle({-.045f, .5f}, {.045f, head}, metal);
    if (stand.condition().lamps)
        stand.glowing_disc({0, head}, .2f, rgb(0xfff0c8));
    else
        stand.disc({0, head}, .17f, rgb(0xd8dcd8));
    stand.rectangle({-.24f, head + .12f}, {.24f, head + .2f}, snowed(stand.condition(), metal));
}

// Long things, with faces in perspective --------------------------------------------------------

// A box along the route, painted by its faces: corners in metres along, away from the path and up.
class Box
{
  public:
    Box(const Landmark &landmark, const Route &route, Canvas &canvas)
        : landmark_(landmark), route_(route), canvas_(canvas)
    {
    }

    const Landmark &landmark() const { return landmark_; }
    Canvas &canvas() { return canvas_; }
    const Condition &condition() const { return canvas_.condition(); }
    // The sun is on the left, so it lights the faces of boxes on the right.
    float side_shade() const { return shade(condition(), landmark_.across < 0); }

    cv::Point3f seen(double along, double out, double up) const
    {
        return canvas_.camera().see(route_.at(landmark_.along + along, landmark_.outward(out)), up);
    }

    std::vector<cv::Point3f> side(cv::Point2f low, cv::Point2f high, double out = 0) const
    {
        return {seen(low.x, out, low.y), seen(high.x, out, low.y), seen(high.x, out, high.y),
                seen(low.x, out, high.y)};
    }

    std::vector<cv::Point3f> end(cv::Point2f low, cv::Point2f high) const
    {
        return {seen(0, low.x, low.y), seen(0, high.x, low.y), seen(0, high.x, high.y),
                seen(0, low.x, high.y)};
    }

    // The two visible walls, and the top.
    void paint_walls(const Colour &colour, const Colour &top)
    {
        const float length = landmark_.length, width = landmark_.width, height = landmark_.height;
        canvas_.face({seen(0, 0, height), seen(length, 0, height), seen(length, width, height),
                      seen(0, width, height)},
                     top);
        canvas_.face(end({0, 0}, {width, height}), colour * shade(condition(), true) * .9f);
        // In pieces, because lamp light and haze change along a wall.
        constexpr int pieces = 3;
        for (int i = pieces - 1; i >= 0; i--)
            canvas_.face(side({length * static_cast<float>(i) / pieces, 0},
                              {length * static_cast<float>(i + 1) / pieces, height}),
                         colour * side_shade());
    }

  private:
    const Landmark &landmark_;
    const Route &route_;
    Canvas &canvas_;
};

void paint_bench(Box &box)
{
    static constexpr std::array<uint32_t, 4> paints = {0x8a5a30, 0x2f6b45, 0xa03030, 0x6b6f74};
    const Colour wood = choose(paints, box.landmark().hue);
    const float length = box.landmark().length, height = box.landmark().height;
    for (float leg : {.1f, length - .15f})
        box.canvas().face(box.side({leg, 0}, {leg + .08f, .45f}, .1), metal * .7f);
    for (float plank : {.5f, .7f})
        box.canvas().face(box.side({0, plank * height}, {length, (plank + .14f) * height}, .5),
                          wood * box.side_shade());
    box.canvas().face({box.seen(0, 0, .45), box.seen(length, 0, .45), box.seen(length, .45, .47),
                       box.seen(0, .45, .47)},
                      snowed(box.condition(), wood));
    box.canvas().face(box.side({0, .38f}, {length, .45f}), wood * .8f);
}

// NOLINTBEGIN(bugprone-float-loop-counter,cert-flp30-c,*FloatLoopCounter): in a picture a step more
// or less does not matter

void paint_fence(Box &box)
{
    static constexpr std::array<uint32_t, 4> paints = {0x7a5a3c, 0xe6e4dc, 0x55504a, 0x3f6a50};
    const Colour wood = choose(paints, box.landmark().hue) * box.side_shade();
    const float length = box.landmark().length, height = box.landmark().height;
    for (float rail : {.35f, .8f})
        box.canvas().face(box.side({0, rail * height}, {length, (rail + .1f) * height}), wood);
    const float gap = box.landmark().shape % 2 ? .45f : 1.2f;
    for (float post = length; post >= 0; post -= gap)
        box.canvas().face(box.side({post, 0}, {post + .13f, height}), wood * .92f);
    if (box.condition().snow > 0)
        box.canvas().face(box.side({0, .9f * height}, {length, .94f * height}), white);
}

void paint_hedge(Box &box)
{
    const Landmark &hedge = box.landmark();
    const Condition &condition = box.condition();
    const Colour leaf = mix(leaf_colour(condition, hedge.hue), rgb(0x3c5530), .5f);
    box.paint_walls(leaf * .8f, snowed(condition, leaf));
    Chance chance(hedge.shape);
    for (int i = 90; i > 0; i--) {
        const float along = hedge.length * static_cast<float>(i) / 90;
        const float up = hedge.height * std::sqrt(chance.unit());
        const float tone = .65f + .45f * up / hedge.height + chance.between(-.15f, .15f);
        const cv::Point3f at = box.seen(along, -.02, up);
        if (at.z > 1)
            Stand(box.canvas(), at)
                .disc({}, chance.between(.1f, .2f),
                      snowed(condition, leaf * tone * box.side_shade(), up > .9f * hedge.height));
    }
}

// A mural, which makes a wall recognisable.
void paint_mural(Box &box, Chance &chance)
{
    static constexpr std::array<uint32_t, 6> sprays = {0xd84040, 0x3070c0, 0xe0b030,
                                                       0x50a060, 0xe8e8e0, 0x8040a0};
    const float length = box.landmark().length, height = box.landmark().height;
    const float middle = length * chance.between(.25f, .75f);
    for (int i = 0; i < 5; i++) {
        const float from = middle + chance.between(-1.8f, .8f),
                    low = height * chance.between(.1f, .5f);
        box.canvas().face(
            box.side({from, low},
                     {from + chance.between(.4f, 1.4f), low + height * chance.between(.15f, .4f)},
                     -.01),
            choose(sprays, chance.unit()) * box.side_shade());
    }
}

void paint_wall(Box &box)
{
    static constexpr std::array<uint32_t, 4> stones = {0x9a5a44, 0xb0a898, 0xc4b48c, 0x7c7c7c};
    const Landmark &wall = box.landmark();
    const Colour stone = choose(stones, wall.hue);
    box.paint_walls(stone, snowed(box.condition(), stone * .9f));
    for (float row = .25f; row < wall.height; row += .3f)
        box.canvas().line(box.seen(0, 0, row), box.seen(wall.length, 0, row), .025f,
                          stone * .72f * box.side_shade());
    Chance chance(wall.shape);
    if (chance.happens(.5f))
        paint_mural(box, chance);
    box.canvas().face(box.side({0, wall.height - .12f}, {wall.length, wall.height}, -.05),
                      snowed(box.condition(), stone * .85f));
}

// A window or door in the side wall.
void paint_opening(Box &box, cv::Point2f low, cv::Point2f high, const Colour &frame, bool lit)
{
    static const Colour glass = rgb(0x41505e), lamplight = rgb(0xffcf7a);
    const cv::Point2f rim(.09f, .09f);
    box.canvas().face(box.side(low - rim, high + rim, -.01), frame * box.side_shade());
    if (lit && box.condition().lamps)
        box.canvas().glowing_face(box.side(low, high, -.02), lamplight);
    else
        box.canvas().face(box.side(low, high, -.02), glass);
}

void paint_facade(Box &box, Chance &chance)
{
    static constexpr std::array<uint32_t, 3> frames = {0xeeece6, 0x6a4a34, 0x3c4a44};
    static constexpr std::array<uint32_t, 4> doors = {0x7a2a24, 0x24506a, 0x3a5a34, 0x6a4a2c};
    const Landmark &house = box.landmark();
    const Colour frame = choose(frames, chance.unit());
    const float pitch = chance.between(1.6f, 2.6f), wide = pitch * chance.between(.35f, .6f);
    const int columns = std::max(1, static_cast<int>(house.length / pitch));
    const auto door = static_cast<int>(chance.below(static_cast<uint32_t>(columns)));
    const float margin = (house.length - static_cast<float>(columns - 1) * pitch - wide) / 2;
    for (float sill = .9f; sill + 1.5f < house.height; sill += 2.7f)
        for (int column = columns - 1; column >= 0; column--) {
            const float left = margin + pitch * static_cast<float>(column);
            const bool lit = chance.happens(.4f);
            if (column == door && sill < 1)
                box.canvas().face(box.side({left, 0}, {left + 1, 2.1f}, -.01),
                                  choose(doors, chance.unit()) * box.side_shade());
            else
                paint_opening(box, {left, sill}, {left + wide, sill + 1.25f}, frame, lit);
        }
}

void paint_house(Box &box)
{
    static constexpr std::array<uint32_t, 8> plasters = {0xd9c9a3, 0xa8604a, 0xe4e0d6, 0xb9c4c9,
                                                         0xd8a878, 0xc9b0a8, 0x9aa88c, 0xe2cf86};
    static constexpr std::array<uint32_t, 3> tiles = {0x8c4632, 0x58504c, 0x6e5a4c};
    const Landmark &house = box.landmark();
    const Condition &condition = box.condition();
    Chance chance(house.shape);
    const Colour plaster = choose(plasters, house.hue), tile = choose(tiles, chance.unit());
    const float length = house.length, width = house.width, eave = house.height;
    const float ridge = eave + width * chance.between(.3f, .5f);

    box.paint_walls(plaster, tile);
    box.canvas().face(
        {box.seen(0, 0, eave), box.seen(0, width, eave), box.seen(0, width / 2, ridge)},
        plaster * shade(condition, true) * .9f);
    box.canvas().face({box.seen(-.2, -.3, eave - .1), box.seen(length + .2, -.3, eave - .1),
                       box.seen(length + .2, width / 2, ridge), box.seen(-.2, width / 2, ridge)},
                      snowed(condition, tile * box.side_shade(), .95f));
    for (float across : {.3f, .65f})
        box.canvas().face(box.end({width * across, .9f}, {width * across + .9f, 2.2f}),
                          rgb(0x41505e));
    paint_facade(box, chance);
}

void paint_tower(Box &box)
{
    static constexpr std::array<uint32_t, 4> coats = {0xb8b0a4, 0x9c6a50, 0xc9c4b4, 0x8e98a0};
    const Landmark &tower = box.landmark();
    const Colour coat = choose(coats, tower.hue);
    box.paint_walls(coat, snowed(box.condition(), coat));
    Chance chance(tower.shape);
    if (chance.happens(.5f)) {
        const float width = tower.width, top = tower.height;
        box.canvas().face({box.seen(0, 0, top), box.seen(0, width, top),
                           box.seen(0, width / 2, top + 1.4 * width)},
                          snowed(box.condition(), rgb(0x5a6a62), .6f));
    }
    for (float sill = 2; sill + 2 < tower.height; sill += 3)
        for (float along = .6f; along + 1 < tower.length; along += 2)
            paint_opening(box, {along, sill}, {along + 1, sill + 1.4f}, coat * .9f,
                          chance.happens(.35f));
}

// NOLINTEND(bugprone-float-loop-counter,cert-flp30-c,*FloatLoopCounter)

// Landmarks without extent along the route.
void paint_standing(const Landmark &landmark, Stand &stand)
{
    switch (landmark.kind) {
    case Kind::tree:
        return paint_tree(landmark, stand);
    case Kind::conifer:
        return paint_conifer(landmark, stand);
    case Kind::bush:
        return paint_bush(landmark, stand);
    case Kind::rock:
        return paint_rock(landmark, stand);
    case Kind::sign:
        return paint_sign(landmark, stand);
    default:
        return paint_lamp(landmark, stand);
    }
}

void paint_box(Box &box)
{
    switch (box.landmark().kind) {
    case Kind::bench:
        return paint_bench(box);
    case Kind::fence:
        return paint_fence(box);
    case Kind::hedge:
        return paint_hedge(box);
    case Kind::wall:
        return paint_wall(box);
    case Kind::house:
        return paint_house(box);
    default:
        return paint_tower(box);
    }
}

} // namespace

void paint_landmark(const Landmark &landmark, const Route &route, Canvas &canvas)
{
    if (landmark.length > 0) {
        Box box(landmark, route, canvas);
        return paint_box(box);
    }
    const cv::Point3f foot = canvas.camera().see(route.at(landmark.along, landmark.across), 0);
    if (foot.z < 1) // its foot has left the picture
        return;
    Stand stand(canvas, foot);
    paint_standing(landmark, stand);
}

} // namespace vdna::simulate
