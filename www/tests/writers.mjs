// The least files of formats that three.js exports none of: one mesh, in millimetres and Z up, as other programs write it.
import { strToU8, zipSync } from "fflate";

/** Triples of a list. */
const triples = (list) => Array.from({ length: list.length / 3 }, (_, i) => list.slice(3 * i, 3 * i + 3));

/** Y up and metres become Z up and millimetres, in numbers of six digits. */
const points = (positions) => triples(Array.from(positions)).map(([x, y, z]) => [x, -z, y].map((number) => Number((1000 * number).toPrecision(6))));

export function asFbx({ positions, indices }) {
  const corners = triples(Array.from(indices)).flatMap(([a, b, c]) => [a, b, -c - 1]); // the last corner of a polygon is its complement
  const numbers = points(positions).flat();
  return `; FBX 7.4.0 project file
FBXHeaderExtension:  {
	FBXVersion: 7400
}
Objects:  {
	Geometry: 1, "Geometry::copy", "Mesh" {
		Vertices: *${numbers.length} {
			a: ${numbers}
		}
		PolygonVertexIndex: *${corners.length} {
			a: ${corners}
		}
	}
	Model: 2, "Model::copy", "Mesh" {
		Version: 232
	}
}
Connections:  {
	C: "OO",2,0
	C: "OO",1,2
}
`;
}

export function asDae({ positions, indices }) {
  const numbers = points(positions);
  return `<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="millimeter" meter="0.001"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="copy"><mesh>
<source id="points"><float_array id="numbers" count="${3 * numbers.length}">${numbers.flat().join(" ")}</float_array>
<technique_common><accessor source="#numbers" count="${numbers.length}" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="vertices"><input semantic="POSITION" source="#points"/></vertices>
<triangles count="${indices.length / 3}"><input semantic="VERTEX" source="#vertices" offset="0"/><p>${Array.from(indices).join(" ")}</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="scene"><node><instance_geometry url="#copy"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#scene"/></scene>
</COLLADA>
`;
}

export function as3mf({ positions, indices }) {
  const vertices = points(positions).map(([x, y, z]) => `<vertex x="${x}" y="${y}" z="${z}"/>`);
  const triangles = triples(Array.from(indices)).map(([a, b, c]) => `<triangle v1="${a}" v2="${b}" v3="${c}"/>`);
  const model = `<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources><object id="1" type="model"><mesh>
<vertices>${vertices.join("")}</vertices><triangles>${triangles.join("")}</triangles>
</mesh></object></resources><build><item objectid="1"/></build></model>
`;
  const relations = `<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
`;
  const types = `<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
`;
  return zipSync({ "[Content_Types].xml": strToU8(types), "_rels/.rels": strToU8(relations), "3D/3dmodel.model": strToU8(model) });
}
