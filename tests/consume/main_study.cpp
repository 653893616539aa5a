// SPDX-License-Identifier: MIT
// The study component: a library and headers of its own.
#include <crofton/study/wrong_lines.hpp>
#include <cstdio>

int main() {
    const crofton::Line line = crofton::study::wrong::line_through_two_box_points({{0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}},
                                                                                  {0.1, 0.2, 0.3, 0.4, 0.5, 0.6});
    std::printf("crofton::study: a line through %g, %g, %g\n", line.point.x, line.point.y, line.point.z);
    return 0;
}
