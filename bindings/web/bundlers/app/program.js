// SPDX-License-Identifier: MIT
// What a page does with the package: it culls boxes, and asks a World for a ray.
export async function run(load) {
    const crofton = await load(), boxes = new crofton.Boxes(100);
    for (let i = 0; i < boxes.length; ++i) boxes.set(i, [0, 0, 50 - i], [0.3, 0.3, 0.3]);
    const visible = new crofton.ViewResult();
    new crofton.Tree(boxes).cull(new crofton.Frustum({ camera: { fovY: 1, far: 1000 } }), visible);
    const world = new crofton.World();
    world.add({ sphere: { center: [0, 0, -5], radius: 1 } });
    world.update();
    return `${visible.ids.length} seen, hit at ${world.raycast([0, 0, 0], [0, 0, -1]).t}`;
}
