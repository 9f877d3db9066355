// Which way is up: the direction of most surface within 60 degrees of the first camera's own up, -y of W.
import * as THREE from "three";
import type { VoxelScene } from "./voxel_scene";

const kCone_cos = Math.cos(Math.PI / 9);
const kTilts = [0, 15, 30, 45];

export function findUp(voxels: VoxelScene): THREE.Vector3 {
  const normals: number[] = [];
  voxels.forEachNormal((x, y, z) => {
    if (-y > 0.5) normals.push(x, y, z);
  });
  const cameraUp = new THREE.Vector3(0, -1, 0);
  let best = cameraUp, most = 0;
  for (const tilt of kTilts) {
    for (let turn = 0; turn < (tilt === 0 ? 1 : 8); ++turn) {
      const seed = cameraUp.clone().applyAxisAngle(new THREE.Vector3(1, 0, 0), (tilt * Math.PI) / 180).applyAxisAngle(cameraUp, (turn * Math.PI) / 4);
      const sum = new THREE.Vector3();
      let count = 0;
      for (let i = 0; i < normals.length; i += 3) {
        if (normals[i] * seed.x + normals[i + 1] * seed.y + normals[i + 2] * seed.z < kCone_cos) continue;
        sum.x += normals[i];
        sum.y += normals[i + 1];
        sum.z += normals[i + 2];
        ++count;
      }
      if (count > most) [most, best] = [count, sum.normalize()];
    }
  }
  return best;
}
