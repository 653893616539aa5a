// SPDX-License-Identifier: MIT
// A program that uses a build without contacts and statistics: everything else answers as always.
#include <crofton/convex/query.hpp>
#include <crofton/crofton.hpp>
#include <cstdio>

namespace {

int wrong = 0;
void expect(bool good, const char* what) {
    if (good) return;
    ++wrong;
    std::printf("wrong: %s\n", what);
}

}  // namespace

int main() {
    crofton::World world({.pairs = false});
    const auto shape = crofton::convex::Shape::box({1.0f, 1.0f, 1.0f});
    const auto crate =
        world.add({.transform = crofton::Transform{glm::dmat3(1.0), {0.0, 0.0, -10.0}}, .shape = &*shape});
    const auto ball = world.add({.bound = crofton::Sphere{{0.5, 0.0, -9.0}, 1.0}});
    const auto behind = world.add({.bound = crofton::Sphere{{0.0, 0.0, 9.0}, 1.0}});
    expect(crate && ball && behind, "objects are added");
    expect(world.update().has_value(), "a World that is not asked for pairs updates");
    crofton::ViewResult visible;
    expect(world.view({.camera = crofton::Camera{}}, visible) && visible.size() == 2, "two objects are in view");
    expect(visible.statistics().nodes_tested == 0, "nothing is counted");
    const auto hit = world.raycast({{0.0, 0.0, 0.0}, {0.0, 0.0, -1.0}});
    expect(hit && ball && hit->object == *ball && hit->t > 8.0 && hit->t < 9.0, "a ray hits the sphere");
    crofton::Vector<crofton::ObjectRef> found;
    world.overlap(*shape, {glm::dmat3(1.0), {0.0, 0.0, -12.0}}, found);
    expect(found.size() == 1 && crate && found[0].object == *crate, "a box that touches the crate finds it");
    expect(world.pairs().empty() && world.contacts().empty(), "there are no pairs and no contacts");

    crofton::World asking;
    expect(asking.add({.bound = crofton::Sphere{{0.0, 0.0, 0.0}, 1.0}}).has_value(), "an object is added");
    const auto updated = asking.update();
    expect(!updated && updated.error().code == crofton::ErrorCode::unsupported, "to ask for pairs is an error");
    expect(asking.view({.camera = crofton::Camera{}}, visible).has_value(), "after the error the World can be asked");
    std::printf("crofton without contacts: %s\n", wrong == 0 ? "answers" : "is wrong");
    return wrong == 0 ? 0 : 1;
}
