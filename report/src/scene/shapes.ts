// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import {
  BoxGeometry, BufferAttribute, BufferGeometry, Color, ConeGeometry, GridHelper, LineBasicMaterial, LineSegments, SphereGeometry, Vector3,
} from "three";
import { mergeGeometries } from "three/examples/jsm/utils/BufferGeometryUtils.js";
import { BadPayload, type PackedMesh } from "../payload.ts";
import { bytesOfBase64 } from "../trace/decode.ts";
import { AXIS_COLOURS } from "../ui/palette.ts";

const COARSE = 500;

/** Three bars of length one along x, y and z, each with its colour. */
export function axesShape(thickness = 0.07): BufferGeometry {
  const bars = AXIS_COLOURS.map((colour, axis) => {
    const size = [thickness, thickness, thickness];
    size[axis] = 1;
    const bar = new BoxGeometry(size[0], size[1], size[2]);
    bar.translate(axis === 0 ? 0.5 : 0, axis === 1 ? 0.5 : 0, axis === 2 ? 0.5 : 0);
    const { r, g, b } = new Color(colour);
    const count = bar.getAttribute("position").count;
    const colours = new Float32Array(3 * count);
    for (let i = 0; i < count; ++i) colours.set([r, g, b], 3 * i);
    bar.setAttribute("axisColour", new BufferAttribute(colours, 3));
    return bar;
  });
  return mergeGeometries(bars);
}

export function ballShape(): BufferGeometry {
  return new SphereGeometry(1, 24, 16);
}

/** A flag of height one: the foot is the position, the pole the z axis, the pennant's tip points along x. */
export function flagShape(): BufferGeometry {
  const pole = new BoxGeometry(0.012, 0.012, 1).translate(0, 0, 0.5).toNonIndexed();
  pole.deleteAttribute("uv");
  const pennant = new BufferGeometry();
  pennant.setAttribute("position", new BufferAttribute(new Float32Array([0, 0, 1, 0, 0, 0.6, 0.6, 0, 0.8]), 3));
  pennant.setAttribute("normal", new BufferAttribute(new Float32Array([0, 1, 0, 0, 1, 0, 0, 1, 0]), 3));
  return mergeGeometries([pole, pennant]);
}

/** A cone with its tip at zero, and the unit circle at z = 1. */
export function coneShape(): BufferGeometry {
  return new ConeGeometry(1, 1, 28, 1, true).translate(0, -0.5, 0).rotateX(-Math.PI / 2);
}

/** A bar from -1 to 1 along z, as thick as the other columns of its linear map. */
export function barShape(): BufferGeometry {
  return new BoxGeometry(1, 1, 2);
}

/** The edges of a camera that looks along z, x to the right and y down, with its image's corners at distance one. */
export function frustum(depth: number, image: readonly [number, number][]): LineSegments<BufferGeometry, LineBasicMaterial> {
  const corners = image.map(([x, y]) => [x, y, 1]);
  const edges: number[][] = [];
  corners.forEach((corner, i) => edges.push([0, 0, 0], corner, corner, corners[(i + 1) % 4]));
  // A small roof says which side is up.
  const [left, right] = [corners[0], corners[1]];
  const at = (share: number, lift: number) => [left[0] + share * (right[0] - left[0]), left[1] - lift * (right[0] - left[0]), 1];
  edges.push(at(0.35, 0.03), at(0.5, 0.15), at(0.5, 0.15), at(0.65, 0.03));
  const points = new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(edges.flat()), 3));
  const lines = new LineSegments(points, new LineBasicMaterial());
  lines.scale.setScalar(depth);
  return lines;
}

/** The rectangle of the image, in the camera's frame, at a distance. */
export function imageShape(depth: number, image: readonly [number, number][]): BufferGeometry {
  const places = [0, 3, 2, 0, 2, 1];
  const uv = [[0, 1], [1, 1], [1, 0], [0, 0]];
  const shape = new BufferGeometry();
  shape.setAttribute("position", new BufferAttribute(new Float32Array(places.flatMap((k) => [depth * image[k][0], depth * image[k][1], depth])), 3));
  shape.setAttribute("uv", new BufferAttribute(new Float32Array(places.flatMap((k) => uv[k])), 2));
  return shape;
}

/** A length of 1, 2 or 5 times a power of ten, about a tenth of a given length. */
export function gridStep(size: number): number {
  const raw = size / 10;
  const power = 10 ** Math.floor(Math.log10(raw));
  return power * (raw / power < 1.5 ? 1 : raw / power < 3.5 ? 2 : 5);
}

export function grid(centre: Vector3, up: Vector3, size: number, height: number): GridHelper {
  const step = gridStep(size);
  const cells = 2 * Math.ceil((0.75 * size) / step);
  const helper = new GridHelper(cells * step, cells, 0x888888, 0x888888);
  helper.material.transparent = true;
  helper.material.opacity = 0.28;
  helper.material.depthWrite = false;
  helper.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), up);
  const snapped = centre.clone().divideScalar(step).round().multiplyScalar(step);
  helper.position.copy(snapped).addScaledVector(up, height - snapped.dot(up));
  return helper;
}

/** The triangles of a mesh in the payload. */
export function meshShape(id: string, packed: PackedMesh): BufferGeometry {
  const vertices = new Float32Array(bytesOfBase64(packed.vertices).buffer);
  const triangles = new Uint32Array(bytesOfBase64(packed.triangles).buffer);
  if (vertices.length % 3 !== 0 || triangles.some((index) => index >= vertices.length / 3)) {
    throw new BadPayload(`The mesh of object ${id} is damaged.`);
  }
  const shape = new BufferGeometry();
  shape.setAttribute("position", new BufferAttribute(vertices, 3));
  shape.setIndex(new BufferAttribute(triangles, 1));
  // Coarse shapes have true edges.
  const drawn = triangles.length / 3 < COARSE ? shape.toNonIndexed() : shape;
  drawn.computeVertexNormals();
  return drawn;
}
