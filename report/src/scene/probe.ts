// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What the scene draws, for tests.
import { Vector3 } from "three";
import type { RunState } from "../state/run_state.ts";
import { DEGREES } from "../math/rotation.ts";
import { imageBox } from "./lens.ts";
import type { SlamScene } from "./slam_scene.ts";

export type SceneProbe = Readonly<Record<string, unknown>>;

/** Where points of the world are in the picture, in pixels. */
function screenOf(scene: SlamScene, point: ArrayLike<number>): [number, number] {
  const { camera, node } = scene.viewport;
  camera.updateMatrixWorld();
  const at = new Vector3(point[0], point[1], point[2]).project(camera);
  return [(0.5 + 0.5 * at.x) * node.clientWidth, (0.5 - 0.5 * at.y) * node.clientHeight];
}

export function sceneProbe(scene: SlamScene, state: RunState): SceneProbe {
  const { viewport, uncertainty, camera } = scene;
  return Object.freeze({
    get counts() { return { ...uncertainty.counts, wireframes: scene.bodies.wireframes }; },
    get factor() { return uncertainty.factor; },
    get look() { return { ...uncertainty.look }; },
    get notes() { return [...viewport.overlay.notes]; },
    get noteLines() { return viewport.overlay.noteLines; },
    get scale() { return { ...viewport.overlay.scale }; },
    get axisEnds() { return viewport.overlay.axisEnds; },
    get labels() { return viewport.labels.shown; },
    get labelsLeft() { return viewport.labels.left; },
    get isFlat() { return viewport.isFlat; },
    get target() { return viewport.controls.target.toArray(); },
    get distance() { return viewport.camera.position.distanceTo(viewport.controls.target); },
    get zoom() { return viewport.camera.zoom; },
    get size() { return [viewport.node.clientWidth, viewport.node.clientHeight]; },
    get image() { return camera.showsImage ? camera.image : -1; },
    get imageBox() { return viewport.lens && imageBox(viewport.lens, viewport.node.clientWidth, viewport.node.clientHeight); },
    get paths() { return scene.objectPaths.node.children.filter(({ visible }) => visible).length; },
    /** Standard deviations of the selected object [mm, deg]. */
    get selected() {
      if (!uncertainty.hasSelected) return undefined;
      const { lengths, alongSd, aboutSd } = uncertainty.selected;
      return {
        principal: Array.from(lengths, (sd) => 1000 * sd), along: Array.from(alongSd, (sd) => 1000 * sd), about: Array.from(aboutSd, (sd) => sd * DEGREES),
      };
    },
    screen: (name: string) => {
      const entity = state.entityOf(name);
      const position = entity === undefined ? undefined : scene.positionOf(entity);
      return position && screenOf(scene, position);
    },
    /** Where the corners of the camera's pyramid are in the picture. */
    corners: () => {
      const scale = scene.camera.depth;
      return camera.corners.map(([x, y]) => screenOf(scene, new Vector3(scale * x, scale * y, scale).applyMatrix4(camera.eye).toArray()));
    },
    point: (x: number, y: number, z: number) => screenOf(scene, [x, y, z]),
  });
}
