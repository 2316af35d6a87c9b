import { markAndFind } from "../mark-and-find.js";

document.title = await markAndFind();
