// SPDX-License-Identifier: MIT
//! A hundred tetrahedra and a sphere that rolls through them: what a camera sees, what touches, what a ray hits.
use crofton::*;

fn main() -> Result<()> {
    let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut world = World::new()?;
    let mesh = world.add_mesh(&MeshData::new(&positions, &[0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]))?;
    for i in 0..100u64 {
        let place = Transform::at([0.9 * (i % 10) as f64 - 4.5, 0.0, -1.5 * (i / 10) as f64]);
        world.add(&Description::mesh(mesh).at(place).user(i))?;
    }
    let sphere = |x| Bound::Sphere { center: [x, 0.2, -3.0], radius: 0.5 };
    let rolling = world.add(&Description::bound(sphere(-6.0)).user(100))?;

    let frustum = Camera::default().frustum()?;
    let mut visible = ViewResult::new()?;
    for frame in 0..10 {
        world.set_bound(rolling, sphere(0.5 * frame as f64 - 6.0))?;
        world.update()?; // once a frame; then ask
        let seen = world.view(&frustum.into(), &mut visible)?.ids().len();
        let touching =
            world.contacts()?.iter().filter(|c| c.second.object == rolling && c.phase != Phase::Ended).count();
        println!("frame {frame}: {seen} of {} objects in view, the sphere touches {touching}", world.object_count());
    }
    if let Some(hit) = world.raycast(&Ray::new([-4.3, 0.2, 5.0], [0.0, 0.0, -1.0]), ALL_LAYERS)? {
        println!("the ray hits object {} at {:.2}", hit.user, hit.t);
    }
    Ok(())
}
