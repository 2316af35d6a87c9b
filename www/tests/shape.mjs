// Compares a value with a type that types.d.ts declares, property by property, through the TypeScript compiler.
import ts from "typescript";

const { TypeFlags } = ts;
const TYPED_ARRAYS = ["Uint8Array", "Uint32Array", "Float32Array", "Float64Array"];

/** The functions and types that a declaration file exports. */
export function readContract(file) {
  const program = ts.createProgram([file], { strict: true, target: ts.ScriptTarget.ES2022, lib: ["lib.es2023.d.ts", "lib.dom.d.ts"], types: [] });
  const checker = program.getTypeChecker();
  const source = program.getSourceFile(file);
  const symbols = checker.getExportsOfModule(checker.getSymbolAtLocation(source));
  const functions = new Map();
  const types = new Map();
  for (const symbol of symbols) {
    if (symbol.flags & ts.SymbolFlags.Function) {
      const [signature] = checker.getTypeOfSymbolAtLocation(symbol, source).getCallSignatures();
      functions.set(symbol.name, signature.parameters.length);
    } else {
      types.set(symbol.name, checker.getDeclaredTypeOfSymbol(symbol));
    }
  }
  return {
    functions,
    /** The names that an interface declares, with those that it inherits. */
    properties: (typeName) => types.get(typeName).getProperties().map(({ name }) => name),
    differences: (typeName, value) => compare(types.get(typeName), value, typeName),
  };

  function compare(type, value, path) {
    if (type.isUnion()) {
      const tries = type.types.map((member) => compare(member, value, path));
      return tries.some((problems) => problems.length === 0) ? [] : [`${path}: ${describe(value)} is not ${checker.typeToString(type)}`];
    }
    if (type.isLiteral() || type.flags & (TypeFlags.Null | TypeFlags.Undefined | TypeFlags.String | TypeFlags.Number | TypeFlags.BooleanLiteral)) {
      return isPrimitive(type, value) ? [] : [`${path}: ${describe(value)} is not ${checker.typeToString(type)}`];
    }
    if (TYPED_ARRAYS.includes(type.symbol?.name)) {
      return value?.constructor.name === type.symbol.name ? [] : [`${path}: ${describe(value)} is not a ${type.symbol.name}`];
    }
    if (checker.isArrayType(type)) {
      const [element] = checker.getTypeArguments(type);
      return Array.isArray(value) ? value.flatMap((item, i) => compare(element, item, `${path}[${i}]`)) : [`${path}: ${describe(value)} is not an array`];
    }
    return compareObject(type, value, path);
  }

  function compareObject(type, value, path) {
    if (typeof value !== "object" || value === null || value instanceof Map) {
      return [`${path}: ${describe(value)} is not an object`];
    }
    const values = checker.getIndexTypeOfType(type, ts.IndexKind.String);
    if (values) {
      return Object.entries(value).flatMap(([key, item]) => compare(values, item, `${path}.${key}`));
    }
    const declared = new Map(type.getProperties().map((property) => [property.name, property]));
    const extra = Object.keys(value).filter((key) => !declared.has(key));
    const problems = extra.map((key) => `${path}.${key} is not declared`);
    for (const [key, property] of declared) {
      if (key in value) {
        problems.push(...compare(checker.getTypeOfSymbol(property), value[key], `${path}.${key}`));
      } else if (!(property.flags & ts.SymbolFlags.Optional)) {
        problems.push(`${path}.${key} is missing`);
      }
    }
    return problems;
  }

  function isPrimitive(type, value) {
    if (type.isLiteral()) {
      return value === type.value;
    }
    return (
      (type.flags & TypeFlags.Null && value === null) ||
      (type.flags & TypeFlags.Undefined && value === undefined) ||
      (type.flags & TypeFlags.String && typeof value === "string") ||
      (type.flags & TypeFlags.Number && Number.isFinite(value)) ||
      (type.flags & TypeFlags.BooleanLiteral && String(value) === checker.typeToString(type))
    );
  }
}

function describe(value) {
  return typeof value === "object" && value !== null ? value.constructor.name : String(JSON.stringify(value));
}
