/** Stands for what gives you the key of who is signed in: 32 bytes, derived in their browser from a passphrase, or fetched. */
export const keyOfThisUser = async () => new Uint8Array(32).fill(9);
